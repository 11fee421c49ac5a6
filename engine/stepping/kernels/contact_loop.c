/* The event-driven loop: exact steps of a piecewise linear system, and where its pieces meet.
 *
 * The system is linear as long as no clearance changes its contact. Each combination of contacts is a *piece* with
 * modes of its own, in which the exponential step is exact; all pieces share one basis, so that going from one to
 * the next is a rotation of the modal coordinates. A step is tried, the cubic through values and rates at its ends
 * tells whether a contact changes within it, and the instant is then found by exact steps of shorter length, so
 * that it does not depend on that cubic.
 *
 * With δ the compression of a flank, F = k δ + c δ̇ in contact; it ends where F would pull. With the law that also
 * keeps the damping below the spring force, F = 2 k δ (*limited*) while c δ̇ > k δ. The part of F beyond k δ is a
 * force of its own, at each flank one: it changes its law at the same state, so that the acceleration is continuous
 * there, and the piece stays the same.
 *
 * The step follows what rings: a mode whose ringing shows in an answer is sampled as finely as the pulsation is, any
 * other mode may be passed over, since its motion is exact whatever the step.
 */
#include "elementary_more.h"
#include "fluxes.h"
#include "modal.h"
#include "step.h"

/* Contact of a flank; the last one is a free flank that is still compressed, in the log only, where it takes load
 * again without having left. */
enum { FREE, DRIVE, DRIVE_LIMITED, BACK, BACK_LIMITED, RECOVERS };
/* What ends a contact (see `condition`), and what else is waited for. */
enum { TOUCHES, RETAKES, PARTS, PASSES, FALLS_BELOW, NONE };
enum { RISING_SPEED = -2, FALLING_SPEED = -3, LOAD_ANGLE = -4, FIELD_CURRENT = -5 }; /* of motor k: less k */

/* Ringing, over an answer's scale, that is sampled as finely as the pulsation; smaller ringing by wider angles, up
 * to this many radians. */
static const double FULL_RINGING = 0.1, WIDEST_ANGLE = 2.4;
/* Shares of a clearance's torque scale: force at which a flank that has not yet recovered takes load again, and
 * pull that counts as none. */
static const double RETAKE = 1e-7, PULL = 1e-13;
/* After so many events at one instant a step is taken without looking for more; after so many such steps in a row
 * the loop gives up. */
/* Torques of motors in time have settled in a step where one more pass would change them by no more, per unit, and
 * after how many passes they are not expected to: changes fall as a geometric series, by 1e-4 a pass as a rule. */
static const double SETTLED = 1e-11;
enum { MOST_PASSES = 40 };
enum { MOST_AT_ONCE = 8, MOST_DWELLS = 10000, MOST_TRIES = 60 };
static const double ROOT_TWO = 1.4142135623730951;
/* Share of the base step after which a table against time is read anew. */
static const double SHORTLY = 1e-6;

typedef struct { double x, y, z; } motion_t; /* compression, its rate and the rate of that */

typedef struct {
    clock_t_ *clock;
    const pieces_t *pieces;
    flanks_t *flanks;
    const drive_t *drive;
    state_t *state;
    output_t *out;
    log_t *log;
    system_t system;                 /* of the present piece; its dampers are those of the present contacts */
    const double *constant, *flank_rows, *shows, *turn;
    int64_t limits;                  /* which flanks are limited, a bit each */
    double *viscous;
    int64_t *acting, n_acting;       /* dampers that act, by their place among all */
    int64_t *needed, n_needed;       /* forces that depend on speed: of machines, and of limited flanks */
    double *u0, *r0, *a0;            /* forces on the modes, their rates, accelerations in the state */
    double *q1, *v1, *a1, *phase1, *f1, *fr1; /* end of the step */
    double *before, *after;          /* motion of the flanks at both ends: x, y, z of `motion_t`, (3, n_flanks) */
    double *base_q, *base_v, *u, *r, *end_q, *end_v, *end_a, *speed, *acceleration;
    double *read, *read_rate;        /* speeds at which curves are read */
    double *jerk;                    /* rates of accelerations */
    held_t *held;                    /* pieces of the curves */
    double *free, *forced, *solver, *matrix, *rotated; /* of a step of any length; room */
    fluxes_t *fluxes, *fluxes1;      /* of each motor in time: in the state, and at the end of the step */
    inverse_t *inverses;             /* of the matrix of its step */
    point_t *air_gap1;               /* its torque there */
    int unsettled;                   /* torque and motion of a motor did not agree in a step */
    double *torque, *torque_rate, *share, *share_rate, *direct_rate, *centre, *centre_rate; /* of a row of output */
} loop_t;

typedef struct { int64_t which, kind; double at; } event_t; /* flank or target; share of the step (2: none) */

enum { FLUX_ROOM = (2 * sizeof(fluxes_t) + sizeof(inverse_t) + sizeof(point_t)) / sizeof(double) };

static int64_t largest_of(int64_t a, int64_t b) { return a > b ? a : b; }

int64_t contact_room(const pieces_t *p, const drive_t *drive)
{
    int64_t wide = largest_of(largest_of(p->n, p->n_forces), p->n_dampers);
    return 15 * p->n + 6 * p->n_flanks + 3 * p->n_forces + 4 * wide + 3 * drive->n_motors + 12 * p->n
           + 8 * p->n_dampers * p->n_dampers + held_room(drive) + 5 * p->n_outputs + 4 * p->n_bodies
           + FLUX_ROOM * drive->machines.n;
}

static double *take(double **room, int64_t n)
{
    double *taken = *room;
    *room += n;
    return taken;
}

static void lay_out(loop_t *l, double *room)
{
    int64_t n = l->pieces->n, nf = l->pieces->n_forces, nd = l->pieces->n_dampers;
    int64_t wide = largest_of(largest_of(n, nf), nd);
    double **of_modes[] = {&l->q1, &l->v1, &l->a1, &l->a0, &l->base_q, &l->base_v, &l->u, &l->r,
                           &l->u0, &l->r0, &l->end_q, &l->end_v, &l->end_a, &l->rotated, &l->jerk};
    for (size_t i = 0; i < sizeof of_modes / sizeof *of_modes; i++) *of_modes[i] = take(&room, n);
    l->before = take(&room, 3 * l->pieces->n_flanks);
    l->after = take(&room, 3 * l->pieces->n_flanks);
    l->f1 = take(&room, nf);
    l->fr1 = take(&room, nf);
    l->speed = take(&room, wide);
    l->acceleration = take(&room, wide);
    l->viscous = take(&room, wide);
    l->acting = (int64_t *)take(&room, wide);
    l->needed = (int64_t *)take(&room, nf);
    l->phase1 = take(&room, l->drive->n_motors);
    l->read = take(&room, l->drive->n_motors);
    l->read_rate = take(&room, l->drive->n_motors);
    l->free = take(&room, 4 * n);
    l->forced = take(&room, 8 * n);
    l->solver = take(&room, 4 * nd * nd);
    l->matrix = take(&room, 4 * nd * nd);
    l->torque = take(&room, l->pieces->n_outputs);
    l->torque_rate = take(&room, l->pieces->n_outputs);
    l->share = take(&room, l->pieces->n_outputs);
    l->share_rate = take(&room, l->pieces->n_outputs);
    l->direct_rate = take(&room, l->pieces->n_outputs);
    l->centre = take(&room, 2 * l->pieces->n_bodies);
    l->centre_rate = take(&room, 2 * l->pieces->n_bodies);
    l->fluxes = (fluxes_t *)take(&room, FLUX_ROOM * l->drive->machines.n);
    l->fluxes1 = l->fluxes + l->drive->machines.n;
    l->inverses = (inverse_t *)(l->fluxes1 + l->drive->machines.n);
    l->air_gap1 = (point_t *)(l->inverses + l->drive->machines.n);
    l->held = (held_t *)take(&room, held_room(l->drive));
    hold_none(l->drive, l->held);
}

/* --- pieces --------------------------------------------------------------------------------------------------- */

/* Coefficients of the flanks, the last of all dampers: zero unless in plain contact; which dampers act. */
static void damp_flanks(loop_t *l)
{
    const flanks_t *f = l->flanks;
    int64_t nc = l->pieces->n_flanks, first = l->pieces->n_dampers - nc;
    l->limits = l->n_needed = 0;
    for (int64_t k = 0; k < l->pieces->n_forces - l->pieces->n_dampers; k++) l->needed[l->n_needed++] = k;
    for (int64_t c = 0; c < nc; c++) {
        int64_t state = f->contact[c], limited = state == DRIVE_LIMITED || state == BACK_LIMITED;
        l->limits = 2 * l->limits + limited;
        if (limited) l->needed[l->n_needed++] = l->pieces->n_forces - nc + c;
        l->viscous[first + c] = state == DRIVE || state == BACK ? f->damping[c] : 0.0;
    }
    l->n_acting = 0;
    for (int64_t d = 0; d < l->pieces->n_dampers; d++)
        if (l->viscous[d] != 0.0) l->acting[l->n_acting++] = d;
}

/* The loop stands in piece s. */
static void stand_in(loop_t *l, int64_t s)
{
    const pieces_t *p = l->pieces;
    const int64_t n = p->n, nf = p->n_forces;
    l->flanks->piece = s;
    l->system = (system_t){n, nf, p->stiffness + s * n, p->rate + s * n, p->reach + s * nf * n,
                           p->mean_speed + s * n, n, p->read_speed + s * l->drive->n_motors * n, p->n_swings,
                           p->n_swing_levels, p->swing_motor, p->swing + s * p->n_swings * p->n_swing_levels * n,
                           p->n_dampers, p->damper_force, l->viscous};
    l->constant = p->constant + s * n;
    l->flank_rows = p->flank_rows + s * p->n_flanks * n;
    l->shows = p->shows + s * n;
    l->turn = p->turns + s * n * n;
}

/* Modal coordinates of the piece into the common basis, or back. */
static void rotate(const loop_t *l, int back, double *x)
{
    const int64_t n = l->pieces->n;
    const double *turn = l->turn;
    double *y = l->rotated;
    for (int64_t i = 0; i < n; i++) y[i] = 0.0;
    for (int64_t i = 0; i < n; i++)
        for (int64_t j = 0; j < n; j++) {
            if (back) y[j] += turn[i * n + j] * x[i];
            else y[i] += turn[i * n + j] * x[j];
        }
    memcpy(x, y, (size_t)n * sizeof *x);
}

static void copy(int64_t n, const double *from, double *to) { memcpy(to, from, (size_t)n * sizeof *to); }

/* Gauss–Jordan with row exchange; 0 where a pivot has no finite inverse. */
static int invert(int64_t n, double *matrix, double *inverse)
{
    for (int64_t i = 0; i < n * n; i++) inverse[i] = i % (n + 1) == 0 ? 1.0 : 0.0;
    for (int64_t i = 0; i < n; i++) {
        int64_t pivot = i;
        double scale;
        for (int64_t k = i + 1; k < n; k++)
            if (fabs(matrix[k * n + i]) > fabs(matrix[pivot * n + i])) pivot = k;
        for (int64_t j = 0; pivot != i && j < n; j++) {
            double a = matrix[i * n + j], b = inverse[i * n + j];
            matrix[i * n + j] = matrix[pivot * n + j];
            matrix[pivot * n + j] = a;
            inverse[i * n + j] = inverse[pivot * n + j];
            inverse[pivot * n + j] = b;
        }
        scale = 1.0 / matrix[i * n + i];
        if (!isfinite(scale)) return 0;
        for (int64_t j = 0; j < n; j++) {
            matrix[i * n + j] *= scale;
            inverse[i * n + j] *= scale;
        }
        for (int64_t k = 0; k < n; k++) {
            double factor = matrix[k * n + i];
            if (k == i || factor == 0.0) continue;
            for (int64_t j = 0; j < n; j++) {
                matrix[k * n + j] -= factor * matrix[i * n + j];
                inverse[k * n + j] -= factor * inverse[i * n + j];
            }
        }
    }
    return 1;
}

/* Inverse of what damper forces and rates at the end of a step do to themselves; 0 where there is none. */
static int damper_solver(const loop_t *l, const double *forced, double *solver)
{
    const system_t *s = &l->system;
    const int64_t nd = l->n_acting, n = s->n, wide = 2 * nd;
    for (int64_t i = 0; i < wide * wide; i++) l->matrix[i] = i % (wide + 1) == 0 ? 1.0 : 0.0;
    for (int64_t d = 0; d < nd; d++) {
        const double *own = s->reach + s->damper_force[l->acting[d]] * n;
        const double c = s->viscous[l->acting[d]];
        for (int64_t e = 0; e < nd; e++) {
            const double *other = s->reach + s->damper_force[l->acting[e]] * n;
            double ww = 0.0, wr = 0.0, aw = 0.0, ar = 0.0;
            for (int64_t i = 0; i < n; i++) {
                double both = own[i] * other[i];
                ww += both * forced[6 * n + i];
                wr += both * forced[7 * n + i];
                aw += both * (1.0 - s->rate[i] * forced[6 * n + i] - s->stiffness[i] * forced[2 * n + i]);
                ar -= both * (s->rate[i] * forced[7 * n + i] + s->stiffness[i] * forced[3 * n + i]);
            }
            l->matrix[d * wide + e] += c * ww;
            l->matrix[d * wide + nd + e] += c * wr;
            l->matrix[(nd + d) * wide + e] += c * aw;
            l->matrix[(nd + d) * wide + nd + e] += c * ar;
        }
    }
    return invert(wide, l->matrix, solver);
}

/* Coefficients of one step for every mode of the piece. */
static void coefficients(const loop_t *l, double h, double *free, double *forced)
{
    const system_t *s = &l->system;
    for (int64_t i = 0; i < s->n; i++) {
        map_t map = exponential_map(s->stiffness[i], s->rate[i], h);
        put_map(&map, s->n, i, 1, 0, free, forced);
    }
}

/* --- forces and steps ----------------------------------------------------------------------------------------- */

/* Damping force of flanks where it is kept at the spring force. */
static void limited_forces(const loop_t *l, const double *q, const double *speed, double *force,
                           double *force_rate)
{
    const flanks_t *fl = l->flanks;
    int64_t n = l->system.n, nc = l->pieces->n_flanks, first = l->system.n_forces - nc;
    for (int64_t c = 0; c < nc; c++) {
        const double *row = l->system.reach + (first + c) * n;
        double x = -fl->gap[c];
        if (fl->contact[c] != DRIVE_LIMITED && fl->contact[c] != BACK_LIMITED) continue;
        for (int64_t i = 0; i < n; i++) x += row[i] * q[i];
        force[first + c] = -fl->stiffness[c] * x;
        force_rate[first + c] = -fl->stiffness[c] * speed[first + c];
    }
}

/* Motions along some rows, four at a time: the sums of one row wait for each other, those of several do not. */
enum { ROWS_AT_ONCE = 4 };

static void along_rows(int64_t n, int64_t n_rows, const int64_t *which, const double *rows, const double *v,
                       const double *a, double *speed, double *acceleration)
{
    int64_t f = 0;
    for (; f + ROWS_AT_ONCE <= n_rows; f += ROWS_AT_ONCE) {
        const double *row[ROWS_AT_ONCE];
        double x[ROWS_AT_ONCE], y[ROWS_AT_ONCE];
        for (int k = 0; k < ROWS_AT_ONCE; k++) {
            row[k] = rows + which[f + k] * n;
            x[k] = y[k] = 0.0;
        }
        for (int64_t i = 0; i < n; i++)
            for (int k = 0; k < ROWS_AT_ONCE; k++) {
                x[k] += row[k][i] * v[i];
                y[k] += row[k][i] * a[i];
            }
        for (int k = 0; k < ROWS_AT_ONCE; k++) {
            speed[which[f + k]] = x[k];
            acceleration[which[f + k]] = y[k];
        }
    }
    for (; f < n_rows; f++) along(n, rows + which[f] * n, v, a, speed + which[f], acceleration + which[f]);
}

/* What forces and their rates do to the modes. */
static void modal_forces(const loop_t *l, const double *force, const double *force_rate, double *u, double *r)
{
    const system_t *s = &l->system;
    for (int64_t i = 0; i < s->n; i++) {
        u[i] = l->constant[i];
        r[i] = 0.0;
    }
    to_modes(s->n, s->n_forces, s->reach, force, force_rate, u, r);
}

/* Accelerations of the state. */
static void accelerations(const loop_t *l, double *a)
{
    const system_t *s = &l->system;
    const double *q = l->state->q, *v = l->state->v;
    for (int64_t i = 0; i < s->n; i++) a[i] = l->u0[i] - s->rate[i] * v[i] - s->stiffness[i] * q[i];
}

/* Speeds at which curves are read, and their rates. */
static void read_speeds(const loop_t *l, const double *v, const double *a, double *read, double *read_rate)
{
    const system_t *s = &l->system;
    for (int64_t m = 0; m < l->drive->n_motors; m++)
        along(s->n_read, s->read_speed + m * s->n_read, v, a, read + m, read_rate + m);
}

/* What acts on the fluxes of a motor under the motion of the modes; `inside` is a time within the step. */
static acting_t acting_on(const loop_t *l, int64_t k, double t, double inside, const double *phase, const double *v,
                          const double *a, const double *jerk)
{
    const system_t *s = &l->system;
    const int64_t m = l->drive->machines.motor[k];
    const double *rows[2] = {s->reach + l->drive->motor_force[m] * s->n, s->read_speed + m * s->n_read};
    const int64_t n_rows[2] = {s->n, s->n_read};
    jet_t moves[2] = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    rotor_t rotor;
    acting_t found;
    for (int j = 0; j < (l->drive->machines.voltage[k] < 0 ? 1 : 2); j++)
        for (int64_t i = 0; i < n_rows[j]; i++) {
            moves[j].value += rows[j][i] * v[i];
            moves[j].slope += rows[j][i] * a[i];
            moves[j].curve += rows[j][i] * jerk[i];
        }
    rotor = (rotor_t){moves[0], moves[1]};
    acting(l->drive, k, t, inside, phase[m], &rotor, &found);
    return found;
}

/* Rates of accelerations. */
static void jerks(const loop_t *l, const double *v, const double *a, const double *r)
{
    const system_t *s = &l->system;
    for (int64_t i = 0; i < s->n; i++) l->jerk[i] = r[i] - s->rate[i] * a[i] - s->stiffness[i] * v[i];
}

/* Fluxes of the state with their derivatives; their torques join the forces. */
static void fresh_fluxes(loop_t *l, double t, const double *a, const double *r)
{
    const machines_t *m = &l->drive->machines;
    if (m->n > 0) jerks(l, l->state->v, a, r);
    for (int64_t k = 0; k < m->n; k++) {
        const acting_t now = acting_on(l, k, t, t + SHORTLY * l->clock->base_step, l->state->phase, l->state->v, a, l->jerk);
        const int64_t f = l->drive->motor_force[m->motor[k]];
        point_t torque;
        copy(m->n_flux[k], m->flux + k * m->most, l->fluxes[k].psi);
        derivatives(m, k, &now, l->fluxes + k);
        torque = air_gap(m, k, l->fluxes + k);
        l->state->force[f] += torque.value;
        l->state->force_rate[f] += torque.slope;
    }
}

/* Fluxes at the end of a step that go on as they began, and their torques: what its first motion is found with. */
static void goes_on(loop_t *l, double h)
{
    const machines_t *m = &l->drive->machines;
    const system_t *s = &l->system;
    for (int64_t k = 0; k < m->n; k++) {
        const point_t now = air_gap(m, k, l->fluxes + k);
        const double *row = s->reach + l->drive->motor_force[m->motor[k]] * s->n;
        point_t *then = l->air_gap1 + k;
        fluxes_go_on(m->n_flux[k], h, l->fluxes + k, l->fluxes1 + k);
        *then = air_gap(m, k, l->fluxes1 + k);
        for (int64_t i = 0; i < s->n; i++) {
            l->u[i] += row[i] * (then->value - now.value - h * now.slope);
            l->r[i] += row[i] * (then->slope - now.slope);
        }
    }
}

/* Fluxes at the end of a step from the motion found last; their torques join the forces. Returns by how much a torque
 * has changed since, over its base. */
static double end_fluxes(loop_t *l, double h)
{
    const machines_t *m = &l->drive->machines;
    const double t = l->clock->time;
    double change = 0.0;
    if (m->n > 0) jerks(l, l->v1, l->a1, l->r);
    for (int64_t k = 0; k < m->n; k++) {
        const acting_t a = acting_on(l, k, t + h, t + 0.5 * h, l->phase1, l->v1, l->a1, l->jerk);
        const int64_t f = l->drive->motor_force[m->motor[k]];
        point_t torque;
        if (!step_fluxes(m, k, h, &a, l->fluxes + k, l->fluxes1 + k, l->inverses + k)) return HUGE_VAL;
        torque = air_gap(m, k, l->fluxes1 + k);
        change = fmax(change, fabs(torque.value - l->air_gap1[k].value) / m->base[k]);
        l->air_gap1[k] = torque;
        l->f1[f] += torque.value;
        l->fr1[f] += torque.slope;
    }
    return change;
}

/* Forces, rates and accelerations of the state, after something has jumped. */
static void fresh_forces(loop_t *l, double t, double *a)
{
    const system_t *s = &l->system;
    state_t *state = l->state;
    for (int64_t f = 0; f < s->n_forces; f++) {
        double unused;
        along(s->n, s->reach + f * s->n, state->v, state->v, l->speed + f, &unused);
        l->acceleration[f] = 0.0;
    }
    read_speeds(l, state->v, state->v, l->read, l->read);
    for (int64_t m = 0; m < l->drive->n_motors; m++) l->read_rate[m] = 0.0;
    for (int64_t i = 0; i < s->n; i++) a[i] = 0.0;
    for (int pass = 0; pass < 3; pass++) { /* rates depend on the acceleration that the forces cause */
        start_forces(t, t + SHORTLY * l->clock->base_step, state->phase, l->speed, l->acceleration, l->read,
                     l->read_rate, l->drive, s, (double *)l->held, state->force, state->force_rate);
        swing_forces(s, l->drive, state->v, a, l->read, l->read_rate, state->force, state->force_rate);
        limited_forces(l, state->q, l->speed, state->force, state->force_rate);
        fresh_fluxes(l, t, a, l->r0);
        modal_forces(l, state->force, state->force_rate, l->u0, l->r0);
        accelerations(l, a);
        for (int64_t f = 0; f < s->n_forces; f++) {
            double unused;
            along(s->n, s->reach + f * s->n, a, a, l->acceleration + f, &unused);
        }
        read_speeds(l, a, a, l->read_rate, l->read_rate);
    }
    if (l->drive->machines.n > 0) jerks(l, state->v, a, l->r0);
    for (int64_t k = 0; k < l->drive->machines.n; k++) { /* with the acceleration found */
        const acting_t now = acting_on(l, k, t, t + SHORTLY * l->clock->base_step, state->phase, state->v, a, l->jerk);
        derivatives(&l->drive->machines, k, &now, l->fluxes + k);
        l->inverses[k].h = 0.0; /* what is connected may have changed */
    }
}

/* Forces of dampers at the end of a step are not iterated but solved for, together with their rates: cubic in the
 * step and equal to the damper's law at both ends, they are stable however strong the damper is. */
static void solve_dampers(const loop_t *l, const step_t *step, const double *solver)
{
    const system_t *s = &l->system;
    const int64_t nd = l->n_acting, wide = 2 * nd;
    if (nd == 0) return;
    end_step(s->n, step, s->stiffness, s->rate, l->base_q, l->base_v, l->u, l->r, l->end_q, l->end_v, l->end_a);
    for (int64_t d = 0; d < nd; d++) { /* motion across each damper without its own end force */
        const int64_t f = s->damper_force[l->acting[d]];
        along(s->n, s->reach + f * s->n, l->end_v, l->end_a, l->speed + d, l->acceleration + d);
        l->speed[d] *= -s->viscous[l->acting[d]];
        l->acceleration[d] *= -s->viscous[l->acting[d]];
    }
    for (int64_t d = 0; d < nd; d++) {
        const int64_t f = s->damper_force[l->acting[d]];
        double x = 0.0, y = 0.0;
        for (int64_t e = 0; e < nd; e++) {
            x += solver[d * wide + e] * l->speed[e] + solver[d * wide + nd + e] * l->acceleration[e];
            y += solver[(nd + d) * wide + e] * l->speed[e]
                 + solver[(nd + d) * wide + nd + e] * l->acceleration[e];
        }
        l->f1[f] += x;
        l->fr1[f] += y;
        to_modes(s->n, 1, s->reach + f * s->n, &x, &y, l->u, l->r);
    }
}

/* One step of the piece: with forces that go on as they do, the forces at the end that this gives, and with those
 * the end. The force of a limited flank depends on where it is: with it the end is found once more; with motors in
 * time until their torques settle. */
static void take_step(loop_t *l, double h, const step_t *step, const double *solver)
{
    const system_t *s = &l->system;
    const state_t *state = l->state;
    const int64_t n = s->n, nf = s->n_forces;
    const double t = l->clock->time;
    double change = HUGE_VAL, left = HUGE_VAL; /* of a torque from the pass before, and what the next one would change */
    const int in_time = l->drive->machines.n > 0;
    copy(n, l->u0, l->u);
    copy(n, l->r0, l->r);
    begin_step(n, step, h, state->q, state->v, l->u, l->r, l->base_q, l->base_v);
    goes_on(l, h);
    for (int pass = l->limits ? 0 : 1; pass < 2 || (in_time && left > SETTLED); pass++) {
        double before = change;
        if (pass == MOST_PASSES) {
            l->unsettled = 1;
            break;
        }
        end_step(n, step, s->stiffness, s->rate, l->base_q, l->base_v, l->u, l->r, l->q1, l->v1, l->a1);
        along_rows(n, l->n_needed, l->needed, s->reach, l->v1, l->a1, l->speed, l->acceleration);
        read_speeds(l, l->v1, l->a1, l->read, l->read_rate);
        turn_phases(l->drive, n, s->reach, h, state->q, l->q1, state->phase, l->phase1);
        machine_forces(l->drive, nf, t + h, t + 0.5 * h, l->phase1, l->speed, l->acceleration, l->read,
                       l->read_rate, l->held, l->f1, l->fr1);
        swing_forces(s, l->drive, l->v1, l->a1, l->read, l->read_rate, l->f1, l->fr1);
        limited_forces(l, l->q1, l->speed, l->f1, l->fr1);
        change = end_fluxes(l, h);
        left = change < before && !isinf(before) ? change * (change / before) : change;
        modal_forces(l, l->f1, l->fr1, l->u, l->r);
        solve_dampers(l, step, solver);
    }
    end_step(n, step, s->stiffness, s->rate, l->base_q, l->base_v, l->u, l->r, l->q1, l->v1, l->a1);
    turn_phases(l->drive, n, s->reach, h, state->q, l->q1, state->phase, l->phase1);
}

/* Takes the end of a step as the new state. */
static void accept(loop_t *l)
{
    const system_t *s = &l->system;
    state_t *state = l->state;
    copy(s->n, l->q1, state->q);
    copy(s->n, l->v1, state->v);
    copy(s->n, l->u, l->u0);
    copy(s->n, l->r, l->r0);
    for (int64_t m = 0; m < l->drive->n_motors; m++) state->phase[m] = in_turn(l->phase1[m]);
    copy(s->n_forces, l->f1, state->force);
    copy(s->n_forces, l->fr1, state->force_rate);
    for (int64_t k = 0; k < l->drive->machines.n; k++) {
        l->fluxes[k] = l->fluxes1[k];
        copy(l->drive->machines.n_flux[k], l->fluxes1[k].psi, l->drive->machines.flux + k * l->drive->machines.most);
    }
}

/* What inputs and their rates give: as `to_modes`, from zero. */
static void sums(int64_t n_out, int64_t n_in, const double *table, const double *in, const double *in_rate,
                 double *out, double *out_rate)
{
    for (int64_t i = 0; i < n_out; i++) out[i] = out_rate[i] = 0.0;
    to_modes(n_out, n_in, table, in, in_rate, out, out_rate);
}

/* Torques and their rates in the state. */
static void torques(const loop_t *l)
{
    const pieces_t *p = l->pieces;
    const state_t *state = l->state;
    const int64_t n = p->n, nf = p->n_forces, no = p->n_outputs, at = l->flanks->piece;
    double *y = l->torque, *rate = l->torque_rate;
    sums(no, n, p->position + at * n * no, state->q, state->v, y, rate);
    if (p->damped[at]) {
        accelerations(l, l->end_a);
        sums(no, n, p->velocity + at * n * no, state->v, l->end_a, l->share, l->share_rate);
        for (int64_t i = 0; i < no; i++) y[i] += l->share[i];
    }
    sums(no, nf, p->direct + at * nf * no, state->force, state->force_rate, l->share, l->direct_rate);
    for (int64_t i = 0; i < no; i++) {
        y[i] = y[i] + l->share[i] + p->offset[at * no + i];
        rate[i] += l->direct_rate[i];
        if (p->damped[at]) rate[i] += l->share_rate[i];
    }
}

/* A row of output. */
static void write_row(loop_t *l, int64_t *rows)
{
    const pieces_t *p = l->pieces;
    const state_t *state = l->state;
    output_t *out = l->out;
    const int64_t k = (*rows)++, n = p->n, nb = p->n_bodies, nm = l->drive->n_motors, at = l->flanks->piece;
    double unused;
    out->time[k] = l->clock->time;
    along(n, l->system.mean_speed, state->v, state->v, out->speed + k, &unused);
    torques(l);
    for (int64_t i = 0; i < p->n_outputs; i++) {
        out->torque[i * out->rows + k] = l->torque[i];
        out->torque_rate[i * out->rows + k] = l->torque_rate[i];
    }
    if (nb) sums(2 * nb, n, p->centres + at * n * 2 * nb, state->q, state->v, l->centre, l->centre_rate);
    for (int64_t i = 0; i < nb; i++) {
        const double stiffness = p->bearing_stiffness[i], damping = p->bearing_damping[i];
        const double *x = l->centre + 2 * i, *y = l->centre_rate + 2 * i;
        out->bearing[i * out->rows + k] = hypotenuse(stiffness * x[0] + damping * y[0], stiffness * x[1] + damping * y[1]);
    }
    copy(nm, state->phase, out->phase + k * nm);
    for (int64_t j = 0; j < l->drive->machines.n; j++) {
        const point_t torque = air_gap(&l->drive->machines, j, l->fluxes + j);
        out->air_gap[2 * (k * l->drive->machines.n + j)] = torque.value;
        out->air_gap[2 * (k * l->drive->machines.n + j) + 1] = torque.slope;
    }
    if (!out->q) return;
    copy(n, state->q, out->q + k * n);
    copy(n, state->v, out->v + k * n);
    out->piece[k] = at;
}

/* How much finer a level is: √2 times from one to the next, exactly twice from one to the next but one. */
static double finer(int64_t level) { return power_of_two(level / 2) * (level % 2 ? ROOT_TWO : 1.0); }

/* How often the base step is made finer: as long as what rings visibly is resolved. */
static int64_t level_of_step(const loop_t *l)
{
    const clock_t_ *clock = l->clock;
    const system_t *s = &l->system;
    const state_t *state = l->state;
    double finest = 1.0, angle = clock->base_step * clock->sampled, halved = 1.0;
    int64_t slowest = s->n, level = 0;
    while (slowest > 0 && s->stiffness[slowest - 1] > clock->sampled * clock->sampled) slowest--;
    for (int64_t i = slowest; i < s->n; i++) { /* beyond the motion that follows the forces */
        double x = state->q[i] - l->u0[i] / s->stiffness[i], v = state->v[i] - l->r0[i] / s->stiffness[i];
        double ringing = l->shows[i] * sqrt(x * x + v * v / s->stiffness[i]);
        if (ringing > clock->visible) {
            /* the cubic through two samples errs by ringing × angle⁴ / 384 */
            double allowed = angle * sqrt(sqrt(FULL_RINGING / ringing)), wanted;
            allowed = allowed < WIDEST_ANGLE ? allowed : WIDEST_ANGLE;
            wanted = sqrt(s->stiffness[i]) * clock->base_step / allowed;
            finest = wanted > finest ? wanted : finest;
        }
    }
    for (; halved < finest && level < l->pieces->levels - 1; level++) halved *= ROOT_TWO;
    return level;
}

/* A step of any length; 0 where the dampers have no solution. */
static int step_of_length(loop_t *l, double h)
{
    const step_t step = {l->free, l->forced};
    coefficients(l, h, l->free, l->forced);
    if (!damper_solver(l, l->forced, l->solver)) return 0;
    take_step(l, h, &step, l->solver);
    return 1;
}

/* A step of a level, its coefficients kept; 0 where the dampers have no solution. */
static int step_of_level(loop_t *l, double h, int64_t level)
{
    const pieces_t *p = l->pieces;
    const int64_t at = l->flanks->piece * p->levels + level;
    double *free = p->free + 4 * p->n * at, *forced = p->forced + 8 * p->n * at;
    double *solver = p->solver + 4 * p->n_dampers * p->n_dampers * at;
    const step_t step = {free, forced};
    if (p->made[at] == 0) coefficients(l, h, free, forced);
    if (p->made[at] != 1 + l->limits) { /* which flanks are limited enters the solver */
        if (!damper_solver(l, forced, solver)) return 0;
        p->made[at] = 1 + l->limits;
    }
    take_step(l, h, &step, solver);
    return 1;
}

/* --- events --------------------------------------------------------------------------------------------------- */

/* Where in [0, 1] the Hermite cubic first falls through zero; 2 if it does not.
 *
 * d0 and d1 are rates per step. A curve that starts at or below zero and rises is not falling. */
double first_fall(double g0, double d0, double g1, double d1)
{
    double rise = g1 - g0, b = 3.0 * rise - 2.0 * d0 - d1, c = d0 + d1 - 2.0 * rise;
    double least = 1e-12 * (fabs(g0) + fabs(d0) + fabs(g1) + fabs(d1));
    double low = 0.0, value = g0, disc, ends[3] = {0.0, 0.0, 1.0};
    if (g0 <= 0.0 && (d0 < 0.0 || (d0 == 0.0 && g1 < 0.0))) return 0.0;
    /* where the control points of the curve lie well above zero, so does all of it: most steps */
    if (g0 > least && g1 > least && g0 + d0 / 3.0 > least && g1 - d1 / 3.0 > least) return 2.0;
    disc = b * b - 3.0 * c * d0;
    if (disc > 0.0) { /* where it turns within the step */
        double root = sqrt(disc), w = b >= 0.0 ? -(b + root) : -(b - root);
        double s1 = w != 0.0 ? d0 / w : -1.0, s2 = c != 0.0 ? w / (3.0 * c) : -1.0;
        if (s1 > s2) {
            double swap = s1;
            s1 = s2;
            s2 = swap;
        }
        if (s1 > 0.0 && s1 < 1.0) ends[0] = s1;
        if (s2 > 0.0 && s2 < 1.0 && s2 > s1) ends[1] = s2;
    }
    for (int i = 0; i < 3; i++) {
        double high = ends[i], next;
        if (high == 0.0) continue;
        next = high == 1.0 ? g1 : g0 + high * (d0 + high * (b + high * c));
        if (value > 0.0 && next <= 0.0) {
            for (int k = 0; k < MOST_TRIES; k++) {
                double middle = 0.5 * (low + high);
                if (g0 + middle * (d0 + middle * (b + middle * c)) > 0.0) low = middle;
                else high = middle;
            }
            return high;
        }
        low = high;
        value = next;
    }
    return 2.0;
}

/* Of all flanks. */
static void motions_of(const loop_t *l, const double *q, const double *v, const double *a, double *motions)
{
    const int64_t n = l->system.n, nc = l->pieces->n_flanks;
    double *restrict x = motions, *restrict y = motions + nc, *restrict z = motions + 2 * nc;
    for (int64_t c = 0; c < nc; c++) {
        x[c] = -l->flanks->gap[c];
        y[c] = z[c] = 0.0;
    }
    for (int64_t i = 0; i < n; i++) {
        const double *row = l->flank_rows + i * nc, qi = q[i], vi = v[i], ai = a[i];
        for (int64_t c = 0; c < nc; c++) {
            x[c] += row[c] * qi;
            y[c] += row[c] * vi;
            z[c] += row[c] * ai;
        }
    }
}

/* Of one flank at the end of the step. */
static motion_t motion_of(const loop_t *l, int64_t c)
{
    const int64_t n = l->system.n, nc = l->pieces->n_flanks;
    motion_t m = {-l->flanks->gap[c], 0.0, 0.0};
    for (int64_t i = 0; i < n; i++) {
        const double across = l->flank_rows[i * nc + c];
        m.x += across * l->q1[i];
        m.y += across * l->v1[i];
        m.z += across * l->a1[i];
    }
    return m;
}

/* What must stay positive for a contact to last, and its rate.
 *
 * Load is taken again at `RETAKE` of the scale: the damping of the pieces differs by that of their modes, and with
 * one threshold for both a flank could part and load without end. */
static point_t condition(const loop_t *l, int64_t kind, int64_t c, motion_t m)
{
    double k = l->flanks->stiffness[c], d = l->flanks->damping[c], scale = l->flanks->scale[c];
    switch (kind) {
    case TOUCHES: return (point_t){-m.x, -m.y};
    case RETAKES: return (point_t){RETAKE * scale - (k * m.x + d * m.y), -(k * m.y + d * m.z)};
    case PARTS: return (point_t){PULL * scale + k * m.x + d * m.y, k * m.y + d * m.z};
    case PASSES: return (point_t){k * m.x - d * m.y, k * m.y - d * m.z};
    default: return (point_t){d * m.y - k * m.x, d * m.z - k * m.y};
    }
}

/* First event of the flanks within a step, by the cubic. */
static void watch_flanks(const loop_t *l, double h, event_t *first)
{
    const flanks_t *fl = l->flanks;
    const int64_t nc = l->pieces->n_flanks;
    const double *m0 = l->before, *m1 = l->after;
    for (int64_t c = 0; c < nc; c++) {
        const int64_t state = fl->contact[c];
        const int damped = fl->damping[c] > 0.0;
        int64_t kinds[2] = {PARTS, NONE};
        const motion_t before = {m0[c], m0[nc + c], m0[2 * nc + c]}, after = {m1[c], m1[nc + c], m1[2 * nc + c]};
        if (isinf(fl->gap[c])) continue;
        if (state == FREE) {
            /* one that is compressed still takes load again, it does not touch */
            kinds[0] = before.x > 0.0 && before.y > 0.0 && damped ? NONE : TOUCHES;
            kinds[1] = before.x > 0.0 && damped ? RETAKES : NONE;
        } else if (state == DRIVE || state == BACK) {
            kinds[1] = fl->limited && damped ? PASSES : NONE;
        } else {
            kinds[0] = FALLS_BELOW;
        }
        for (int j = 0; j < 2; j++) {
            point_t g0, g1;
            double at;
            if (kinds[j] == NONE) continue;
            g0 = condition(l, kinds[j], c, before);
            g1 = condition(l, kinds[j], c, after);
            at = first_fall(g0.value, g0.slope * h, g1.value, g1.slope * h);
            if (at < first->at) *first = (event_t){c, kinds[j], at};
        }
    }
}

/* Mean speed beyond which a target lies, and its rate. */
static point_t speed_left(const loop_t *l, int64_t target, const double *v, const double *a)
{
    double speed, rate, sign = target == RISING_SPEED ? 1.0 : -1.0;
    along(l->system.n, l->system.mean_speed, v, a, &speed, &rate);
    return (point_t){sign * ((target == RISING_SPEED ? l->clock->rising : l->clock->falling) - speed),
                     -sign * rate};
}

/* First of the speeds, the load angle and the currents of fields that the run waits for. */
static void watch_targets(const loop_t *l, double h, event_t *first)
{
    const clock_t_ *clock = l->clock;
    double at;
    for (int64_t k = 0; k < l->drive->machines.n; k++) {
        point_t g0, g1;
        if (!l->drive->machines.watched[k]) continue;
        g0 = field_left(&l->drive->machines, k, l->fluxes + k);
        g1 = field_left(&l->drive->machines, k, l->fluxes1 + k);
        at = first_fall(g0.value, g0.slope * h, g1.value, g1.slope * h);
        if (at < first->at) *first = (event_t){FIELD_CURRENT - k, NONE, at};
    }
    for (int64_t target = RISING_SPEED; target >= FALLING_SPEED; target--) {
        point_t g0, g1;
        if (isinf(target == RISING_SPEED ? clock->rising : clock->falling)) continue;
        g0 = speed_left(l, target, l->state->v, l->a0);
        g1 = speed_left(l, target, l->v1, l->a1);
        if (g0.value <= 0.0) g0 = (point_t){0.0, -1.0};
        at = first_fall(g0.value, g0.slope * h, g1.value, g1.slope * h);
        if (at < first->at) *first = (event_t){target, NONE, at};
    }
    if (clock->angle == clock->angle) {
        /* the load angle rises through the wanted one: −sin(δ − δ*) falls with cos > 0 */
        double before = 0.5 * l->state->phase[0] - clock->angle, after = 0.5 * l->phase1[0] - clock->angle;
        double rate = 0.5 * (l->phase1[0] - l->state->phase[0]);
        sincos_t a = sin_cos(before), b = sin_cos(after);
        if (a.cosine <= 0.0 && b.cosine <= 0.0) return;
        /* passed already; the next turn will do */
        if (-a.sine <= 0.0 && -a.cosine * rate < 0.0 && before != 0.0) return;
        at = first_fall(-a.sine, -a.cosine * rate, -b.sine, -b.cosine * rate);
        if (at < first->at) *first = (event_t){LOAD_ANGLE, NONE, at};
    }
}

/* What an event waits for, at the end of a step of length h; the flank's motion there. */
static point_t waited_for(const loop_t *l, event_t event, double h, motion_t *flank)
{
    if (event.which >= 0) {
        *flank = motion_of(l, event.which);
        return condition(l, event.kind, event.which, *flank);
    }
    if (event.which == LOAD_ANGLE) {
        sincos_t wave = sin_cos(0.5 * l->phase1[0] - l->clock->angle);
        double rate = 0.5 * (l->phase1[0] - l->state->phase[0]) / (h > 1e-300 ? h : 1e-300);
        return (point_t){-wave.sine, -wave.cosine * rate};
    }
    if (event.which <= FIELD_CURRENT)
        return field_left(&l->drive->machines, FIELD_CURRENT - event.which, l->fluxes1 + (FIELD_CURRENT - event.which));
    return speed_left(l, event.which, l->v1, l->a1);
}

/* The end of a step of no length. */
static void stay(loop_t *l)
{
    const system_t *s = &l->system;
    copy(s->n, l->state->q, l->q1);
    copy(s->n, l->state->v, l->v1);
    copy(s->n, l->a0, l->a1);
    copy(s->n, l->u0, l->u);
    copy(s->n, l->r0, l->r);
    copy(l->drive->n_motors, l->state->phase, l->phase1);
    copy(s->n_forces, l->state->force, l->f1);
    copy(s->n_forces, l->state->force_rate, l->fr1);
    for (int64_t k = 0; k < l->drive->machines.n; k++) l->fluxes1[k] = l->fluxes[k];
}

/* The instant of an event, by exact steps: a bracket with the condition lost at its end. The loop stands at the
 * end of a step of length `tau` then. Returns 0 where the dampers have no solution; `lost` says whether the
 * condition is lost there at all, which the cubic may have seen wrongly. */
static int locate(loop_t *l, event_t event, double h, double *tau, int *lost, motion_t *flank)
{
    double low = 0.0, high = h;
    const double close = 1e-13 * h + 4e-16 * l->clock->time;
    *tau = event.at * h;
    *lost = 1;
    for (int k = 0; k < MOST_TRIES; k++) {
        point_t g;
        double next;
        if (*tau <= 0.0) stay(l);
        else if (!step_of_length(l, *tau)) return 0;
        g = waited_for(l, event, *tau, flank);
        if (*tau <= 0.0) return 1;
        if (g.value <= 0.0) high = *tau;
        else low = *tau;
        next = g.slope < 0.0 ? *tau - g.value / g.slope : 0.5 * (low + high);
        if (!(low < next && next < high)) next = 0.5 * (low + high);
        if (fabs(next - *tau) <= close || high - low <= close) {
            *lost = g.value <= 0.0 || g.slope < 0.0;
            return 1;
        }
        *tau = next;
    }
    return 1;
}

/* The first event of a step and its instant, as `locate` has it. Over the shorter step that an event leaves the cubics
 * are nearer: one that comes before it may show now. */
static int locate_first(loop_t *l, event_t *event, double h, double *tau, int *lost, motion_t *flank)
{
    for (int k = 0; k < MOST_TRIES; k++) {
        event_t sooner = {0, NONE, 2.0};
        if (!locate(l, *event, h, tau, lost, flank)) return 0;
        if (*tau <= 0.0) return 1;
        motions_of(l, l->q1, l->v1, l->a1, l->after);
        watch_flanks(l, *tau, &sooner);
        watch_targets(l, *tau, &sooner);
        if (sooner.at > 1.0 - 1e-9 || (sooner.which == event->which && sooner.kind == event->kind)) return 1;
        h = *tau;
        *event = sooner;
    }
    return 1;
}

/* Logs the change of contact of a flank and makes it. */
static void change_contact(loop_t *l, event_t event, double speed)
{
    const int64_t c = event.which, nc = l->pieces->n_flanks;
    int64_t before = l->flanks->contact[c], after = FREE;
    double *row = l->log->log + 5 * l->log->n++;
    if (event.kind == TOUCHES || event.kind == RETAKES) {
        after = 2 * c < nc ? DRIVE : BACK;
        if (event.kind == TOUCHES && l->flanks->limited && l->flanks->damping[c] > 0.0) after++;
        if (event.kind == RETAKES) before = RECOVERS;
    } else if (event.kind == PASSES) {
        after = before + 1;
    } else if (event.kind == FALLS_BELOW) {
        after = before - 1;
    }
    l->flanks->contact[c] = after;
    row[0] = l->clock->time;
    row[1] = (double)(c % (nc / 2));
    row[2] = (double)before;
    row[3] = (double)after;
    row[4] = speed;
    damp_flanks(l);
}

/* Into the piece of the present contacts; 0 where it has to be made first: the state is in the common basis then. */
static int enter_piece(loop_t *l)
{
    const pieces_t *p = l->pieces;
    int64_t key = 0, other = -1;
    for (int64_t c = p->n_flanks - 1; c >= 0; c--) /* limited or not: the same piece */
        key = 2 * key + (l->flanks->contact[c] != FREE);
    for (int64_t k = 0; k < p->n_pieces; k++)
        if (p->keys[k] == key) other = k;
    rotate(l, 0, l->state->q);
    rotate(l, 0, l->state->v);
    if (other < 0) {
        l->flanks->piece = -1;
        return 0;
    }
    stand_in(l, other);
    rotate(l, 1, l->state->q);
    rotate(l, 1, l->state->v);
    return 1;
}

/* --- the loop ------------------------------------------------------------------------------------------------- */

/* Passes the stops up to now. */
static void pass_stops(clock_t_ *clock)
{
    while (clock->stop < clock->n_stops && clock->stops[clock->stop] <= clock->time * (1.0 + 1e-14) + 1e-15)
        clock->stop++;
}

/* End of the run, or the next time before it at which a step has to end. */
static double next_end(const clock_t_ *clock)
{
    if (clock->stop < clock->n_stops && clock->stops[clock->stop] < clock->end_time)
        return clock->stops[clock->stop];
    return clock->end_time;
}

static int64_t come_back(loop_t *l, int64_t fresh, int64_t reason)
{
    l->clock->fresh = fresh;
    return reason;
}

/* Steps from one event to the next until something has to be decided outside; says why it came back. At an event two
 * rows are written for one instant, one a piece. */
int64_t advance_pieces(clock_t_ *clock, const pieces_t *pieces, flanks_t *flanks, const drive_t *drive,
                       state_t *state, output_t *out, log_t *log, double *room, int64_t *done)
{
    loop_t loop = {.clock = clock, .pieces = pieces, .flanks = flanks, .drive = drive, .state = state,
                   .out = out, .log = log};
    loop_t *l = &loop;
    const int64_t n = pieces->n;
    int64_t at_once = 0, dwells = 0, *rows = done;
    int fresh = clock->fresh > 0;
    *rows = 0;
    log->n = 0;
    for (int64_t k = 0; k < drive->machines.n; k++)
        if (drive->machines.n_flux[k] > MOST_FLUX || !isfinite(drive->machines.flux[k * drive->machines.most]))
            return UNSETTLED;
    lay_out(l, room);
    copy(pieces->n_dampers, pieces->viscous + flanks->piece * pieces->n_dampers, l->viscous);
    damp_flanks(l);
    stand_in(l, flanks->piece);
    if (clock->fresh != 1) pass_stops(clock); /* else the row after the stop is still to be written */
    for (;;) {
        event_t event = {0, NONE, 2.0};
        motion_t flank = {0.0, 0.0, 0.0};
        /* contacts that would change to and fro at one instant (the damping of the pieces differs) are left alone
         * for the shortest of all steps */
        const int dwell = at_once > MOST_AT_ONCE;
        int64_t level;
        double h, tau, end, remaining;
        int whole, lost;
        if (*rows >= out->rows - 2 || log->n >= log->room - 1) return come_back(l, 1, MORE);
        if (fresh) {
            fresh_forces(l, clock->time, l->a0);
            motions_of(l, l->state->q, l->state->v, l->a0, l->before);
            if (clock->fresh > 1) write_row(l, rows);
            clock->fresh = fresh = 0;
        } else {
            copy(n, l->a1, l->a0);
        }
        level = dwell ? pieces->levels - 1 : level_of_step(l);
        h = clock->base_step / finer(level);
        end = next_end(clock);
        remaining = end - clock->time;
        if (remaining <= 1e-12 * clock->base_step) {
            clock->time = end;
            if (end >= clock->end_time) return come_back(l, 1, AT_TIME);
            pass_stops(clock);
            clock->fresh = 2; /* a table against time may jump here */
            fresh = 1;
            continue;
        }
        whole = h < remaining * (1.0 - 1e-9);
        if (!whole) h = remaining;
        if (!(whole ? step_of_level(l, h, level) : step_of_length(l, h))) return come_back(l, 1, DIVIDED);
        if (l->unsettled) return come_back(l, 1, UNSETTLED);
        motions_of(l, l->q1, l->v1, l->a1, l->after);
        if (!dwell) watch_flanks(l, h, &event);
        watch_targets(l, h, &event);
        if (event.at > 1.0) { /* nothing happened */
            clock->time = whole ? clock->time + h : end;
            at_once = 0;
            dwells = dwell ? dwells + 1 : 0;
            accept(l);
            copy(3 * pieces->n_flanks, l->after, l->before);
            write_row(l, rows);
            continue;
        }
        if (!locate_first(l, &event, h, &tau, &lost, &flank)) return come_back(l, 1, DIVIDED);
        if (l->unsettled) return come_back(l, 1, UNSETTLED);
        clock->time += tau;
        at_once = tau <= 1e-9 * h ? at_once + 1 : 0;
        accept(l);
        motions_of(l, l->q1, l->v1, l->a1, l->before);
        write_row(l, rows);
        if (dwells > MOST_DWELLS) return come_back(l, 1, STUCK);
        if (event.which <= FIELD_CURRENT) {
            if (!lost) continue; /* the cubic saw a change of sign that the exact step does not have */
            clock->turned = FIELD_CURRENT - event.which;
            return come_back(l, 2, TURNED);
        }
        if (event.which < 0) return come_back(l, 1, event.which == LOAD_ANGLE ? ANGLE : SPEED);
        if (!lost) continue; /* the cubic saw a touch that the exact step does not have */
        /* it has left meanwhile, and is damped already before it touches: `TOUCHES` watches */
        if (event.kind == RETAKES && flank.x <= 0.0) continue;
        change_contact(l, event, flank.y);
        if (!enter_piece(l)) return come_back(l, 2, NEW_PIECE);
        fresh_forces(l, clock->time, l->a1);
        motions_of(l, l->state->q, l->state->v, l->a1, l->before);
        write_row(l, rows);
    }
}
