/* Fixed steps of a linear train under motors and loads; prescribed forces; turning points. */
#include "modal.h"
#include "step.h"

enum { ARRAYS_OF_MODES = 7 + 12, ARRAYS_OF_FORCES = 4 };

void polynomial_step(int64_t n, const double *stiffness, const double *rate, double h, double *free,
                     double *forced)
{
    for (int64_t i = 0; i < n; i++) {
        map_t map = polynomial_map(stiffness[i], rate[i], h);
        put_map(&map, 1, 0, free + 4 * i, forced + 8 * i);
    }
}

void exponential_step(int64_t n, const double *stiffness, const double *rate, double h, double *free,
                      double *forced)
{
    for (int64_t i = 0; i < n; i++) {
        map_t map = exponential_map(stiffness[i], rate[i], h);
        put_map(&map, 1, 0, free + 4 * i, forced + 8 * i);
    }
}

void newmark_step(int64_t n, const double *stiffness, const double *rate, double h, double *free,
                  double *forced)
{
    for (int64_t i = 0; i < n; i++) {
        map_t map = newmark_map(stiffness[i], rate[i], h);
        put_map(&map, 1, 0, free + 4 * i, forced + 8 * i);
    }
}

void start_forces(double t, double inside, const double *phase, const double *speed,
                  const double *acceleration, const drive_t *drive, const system_t *system, double *force,
                  double *force_rate)
{
    machine_forces(drive, system->n_forces, t, inside, phase, speed, acceleration, force, force_rate);
    damper_forces(system->n_dampers, system->damper_force, system->viscous, speed, acceleration, force,
                  force_rate);
}

int64_t linear_room(const system_t *system, const drive_t *drive)
{
    return ARRAYS_OF_MODES * system->n + ARRAYS_OF_FORCES * system->n_forces + drive->n_motors;
}

/* Room to work in: coefficients of the step, its forces without and with its end, its end. */
typedef struct {
    double *free, *forced, *base_q, *base_v, *u, *r, *q1, *v1, *a1, *f1, *fr1, *speed, *acceleration, *phase1;
} room_t;

static room_t laid_out(const system_t *s, double *room)
{
    const int64_t n = s->n, nf = s->n_forces;
    room_t w = {.free = room, .forced = room + 4 * n};
    double **of_modes[] = {&w.base_q, &w.base_v, &w.u, &w.r, &w.q1, &w.v1, &w.a1};
    double **of_forces[] = {&w.f1, &w.fr1, &w.speed, &w.acceleration};
    room += 12 * n;
    for (int i = 0; i < 7; i++, room += n) *of_modes[i] = room;
    for (int i = 0; i < 4; i++, room += nf) *of_forces[i] = room;
    w.phase1 = room;
    return w;
}

/* Forces and their rates in the state; the rates depend on the acceleration that the forces cause. */
static void renew_forces(double t, double inside, const system_t *s, const drive_t *drive, state_t *state,
                         const room_t *w)
{
    for (int64_t f = 0; f < s->n_forces; f++) {
        double unused;
        along(s->n, s->reach + f * s->n, state->v, state->v, w->speed + f, &unused);
        w->acceleration[f] = 0.0;
    }
    for (int pass = 0; pass < 2; pass++) {
        start_forces(t, inside, state->phase, w->speed, w->acceleration, drive, s, state->force,
                     state->force_rate);
        for (int64_t i = 0; i < s->n; i++) {
            w->a1[i] = -s->rate[i] * state->v[i] - s->stiffness[i] * state->q[i];
            w->r[i] = 0.0;
        }
        to_modes(s->n, s->n_forces, s->reach, state->force, state->force_rate, w->a1, w->r);
        for (int64_t f = 0; f < s->n_forces; f++) {
            double unused;
            along(s->n, s->reach + f * s->n, w->a1, w->a1, w->acceleration + f, &unused);
        }
    }
}

void forces_at(double t, double inside, const system_t *system, const drive_t *drive, state_t *state,
               double *room)
{
    room_t w = laid_out(system, room);
    renew_forces(t, inside, system, drive, state, &w);
}

/* One step: predict and evaluate, correct and evaluate. */
static void take_step(double t, double h, const system_t *s, const drive_t *drive, const state_t *state,
                      const room_t *w)
{
    const int64_t n = s->n, nf = s->n_forces;
    const step_t step = {w->free, w->forced};
    for (int64_t i = 0; i < n; i++) w->u[i] = w->r[i] = 0.0;
    to_modes(n, nf, s->reach, state->force, state->force_rate, w->u, w->r);
    begin_step(n, &step, h, state->q, state->v, w->u, w->r, w->base_q, w->base_v);
    for (int pass = 0; pass < 2; pass++) {
        end_step(n, &step, s->stiffness, s->rate, w->base_q, w->base_v, w->u, w->r, w->q1, w->v1, w->a1);
        for (int64_t f = 0; f < nf; f++)
            along(n, s->reach + f * n, w->v1, w->a1, w->speed + f, w->acceleration + f);
        turn_phases(drive, n, s->reach, h, state->q, w->q1, state->phase, w->phase1);
        start_forces(t + h, t + 0.5 * h, w->phase1, w->speed, w->acceleration, drive, s, w->f1, w->fr1);
        if (pass == 1) return;
        for (int64_t i = 0; i < n; i++) w->u[i] = w->r[i] = 0.0;
        to_modes(n, nf, s->reach, w->f1, w->fr1, w->u, w->r);
    }
}

/* Takes the end of a step as the new state, and a row of output; the mean speed. */
static double accept(const system_t *s, const drive_t *drive, state_t *state, const room_t *w, output_t *out,
                     int64_t k)
{
    double mean = 0.0;
    for (int64_t i = 0; i < s->n; i++) {
        state->q[i] = out->q[k * s->n + i] = w->q1[i];
        state->v[i] = out->v[k * s->n + i] = w->v1[i];
        mean += s->mean_speed[i] * w->v1[i];
    }
    for (int64_t m = 0; m < drive->n_motors; m++) state->phase[m] = in_turn(w->phase1[m]);
    for (int64_t f = 0; f < s->n_forces; f++) {
        state->force[f] = out->force[k * s->n_forces + f] = w->f1[f];
        state->force_rate[f] = out->force_rate[k * s->n_forces + f] = w->fr1[f];
    }
    return mean;
}

/* Steps stretch by stretch until the end, the mean speed is reached, or the output is full. */
int64_t advance_start(stretches_t *plan, const system_t *system, const drive_t *drive, state_t *state,
                      output_t *out, double *room, int64_t *done)
{
    const room_t w = laid_out(system, room);
    double made = 0.0; /* step of the coefficients at hand */
    *done = 0;
    for (; plan->at < plan->n; plan->at++, plan->taken = 0) {
        const double h = plan->steps[plan->at];
        for (int64_t i = 0; h != made && i < system->n; i++) {
            map_t map = (plan->newmark ? newmark_map : exponential_map)(system->stiffness[i],
                                                                        system->rate[i], h);
            put_map(&map, system->n, i, w.free, w.forced);
        }
        made = h;
        if (plan->taken == 0)
            renew_forces(plan->time, plan->time + 0.5 * h, system, drive, state, &w);
        while (plan->taken < plan->counts[plan->at]) {
            double mean;
            if (*done == out->rows) return MORE;
            take_step(plan->time + h * (double)plan->taken, h, system, drive, state, &w);
            mean = accept(system, drive, state, &w, out, *done);
            out->time[(*done)++] = plan->time + h * (double)++plan->taken;
            if (mean >= plan->target_speed) return SPEED;
        }
        plan->time += h * (double)plan->taken;
    }
    return AT_TIME;
}

/* Uncoupled modes under prescribed modal forces, cubics of each step: (n_steps, n, 4); room for 12 n numbers. */
void drive_modes(int64_t n_steps, int64_t n, const double *steps, const double *stiffness,
                 const double *rate, const double *cubic, double *q, double *v, double *out_q, double *out_v,
                 double *room)
{
    double *free = room, *forced = room + 4 * n;
    for (int64_t k = 0; k < n_steps; k++) {
        if (k == 0 || steps[k] != steps[k - 1]) polynomial_step(n, stiffness, rate, steps[k], free, forced);
        for (int64_t i = 0; i < n; i++) {
            const double *c = cubic + 4 * (k * n + i), *a = free + 4 * i, *b = forced + 8 * i;
            double x = a[0] * q[i] + a[1] * v[i], y = a[2] * q[i] + a[3] * v[i];
            for (int j = 0; j < 4; j++) {
                x += b[j] * c[j];
                y += b[4 + j] * c[j];
            }
            q[i] = out_q[k * n + i] = x;
            v[i] = out_v[k * n + i] = y;
        }
    }
}

/* A coupled linear system under prescribed forces. */
void drive_coupled(int64_t n_steps, int64_t n_state, int64_t n_modes, const double *free,
                   const double *forced, const double *cubic, double *state, double *out, double *room)
{
    for (int64_t k = 0; k < n_steps; k++) {
        const double *c = cubic + 4 * k * n_modes;
        for (int64_t i = 0; i < n_state; i++) {
            const double *row = free + i * n_state, *push = forced + 4 * i * n_modes;
            double x = 0.0;
            for (int64_t j = 0; j < n_state; j++) x += row[j] * state[j];
            for (int64_t j = 0; j < 4 * n_modes; j++) x += push[j] * c[j];
            room[i] = x;
        }
        for (int64_t i = 0; i < n_state; i++) state[i] = out[k * n_state + i] = room[i];
    }
}

/* Where the derivative d0 + b s + c s² of a cubic is zero, in rising order; −1 where it is not. */
static int turns(double d0, double b, double c, double at[2])
{
    double disc = b * b - 4.0 * c * d0, root, w;
    if (!(disc > 0.0)) return 0;
    root = sqrt(disc);
    w = b >= 0.0 ? -0.5 * (b + root) : -0.5 * (b - root);
    at[0] = w != 0.0 ? d0 / w : -1.0;
    at[1] = c != 0.0 ? w / c : -1.0;
    if (at[0] > at[1]) {
        double swap = at[0];
        at[0] = at[1];
        at[1] = swap;
    }
    return 1;
}

/* Turning points of a piecewise cubic through values and slopes; at most 2 n. Returns how many.
 *
 * One within rounding of a sample may come twice, but is never missed. Two samples at one time are a corner or
 * a jump: both values count where the curve turns or jumps there. */
int64_t turning_points(int64_t n, const double *t, const double *y, const double *slope, double *when,
                       double *value)
{
    int64_t found = 0;
    double size = 0.0;
    for (int64_t i = 0; i < n; i++) size = fabs(y[i]) > size ? fabs(y[i]) : size;
    for (int64_t i = 0; i + 1 < n; i++) {
        double h = t[i + 1] - t[i], rise = y[i + 1] - y[i], d0, d1, b, c, at[2];
        if (h <= 0.0) { /* in free flight the slope is zero on one side: entry and exit count */
            if (fabs(rise) > 1e-9 * size || slope[i] * slope[i + 1] <= 0.0)
                for (int64_t j = i; j < i + 2; j++) {
                    when[found] = t[j];
                    value[found++] = y[j];
                }
            continue;
        }
        d0 = h * slope[i];
        d1 = h * slope[i + 1];
        b = 6.0 * rise - 4.0 * d0 - 2.0 * d1;
        c = 3.0 * (d0 + d1) - 6.0 * rise;
        if (!turns(d0, b, c, at)) continue;
        for (int j = 0; j < 2; j++) {
            double s = at[j];
            if (!(s >= -1e-12 && s <= 1.0 + 1e-12)) continue;
            s = s < 0.0 ? 0.0 : s > 1.0 ? 1.0 : s;
            when[found] = t[i] + s * h;
            value[found++] = y[i] + s * (d0 + s * (0.5 * b + s * c / 3.0));
        }
    }
    return found;
}

void elementary(int64_t n, const double *x, double *sine, double *cosine, double *grown)
{
    for (int64_t i = 0; i < n; i++) {
        sincos_t wave = sin_cos(x[i]);
        sine[i] = wave.sine;
        cosine[i] = wave.cosine;
        grown[i] = exponential(x[i]);
    }
}
