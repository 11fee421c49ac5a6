/* Starts without events, one a lane: fixed steps under motors and loads. Written once on lane_t; each source that
 * includes it names its two functions, BEGIN and ADVANCE. */
#include "modal.h"
#include "step.h"
#include "turning.h"

/* Room to work in: coefficients of the step, its forces without and with its end, its end. What many lanes take as it
 * comes a single start takes ROWS at a time, from copies: `q` … `largest` are the state and what it leaves. */
typedef struct {
    int64_t modes, forces, motors, outputs; /* how many wide_t these are */
    wide_t *free, *forced, *base_q, *base_v, *u, *r, *q1, *v1, *a1, *speed, *acceleration, *read, *read_rate;
    wide_t *stiffness, *rate, *reach, *q, *v;
    wide_t *along_forces, *along_read, *position, *velocity, *of_force; /* blocks: (n_blocks, n, ROWS; lanes) */
    wide_t *last, *last_rate, *before, *before_rate, *largest;
    lane_t *f1, *fr1, *phase1;
    held_t *held;
} room_t;

static int64_t blocks(int64_t n) { return (n + ROWS - 1) / ROWS; }

#if ROWS == 1
static wide_t *as_blocks(int64_t n, int64_t m, const double *matrix, wide_t **at) { return (wide_t *)matrix; }
static wide_t *as_rows(int64_t n, int64_t m, const double *matrix, wide_t **at) { return (wide_t *)matrix; }
static void give_back(int64_t n, const wide_t *from, double *to) {}
#else
/* A matrix (n, m) in blocks of rows. The last block is filled by repeating the last row. */
static wide_t *as_blocks(int64_t n, int64_t m, const double *matrix, wide_t **at)
{
    wide_t *made = *at;
    *at += blocks(n) * m;
    for (int64_t i = 0; matrix && i < ROWS * blocks(n); i++)
        for (int64_t j = 0; j < m; j++)
            made[i / ROWS * m + j][i % ROWS] = matrix[(i < n ? i : n - 1) * m + j];
    return made;
}

/* A matrix (n, m), each row filled by zeros. */
static wide_t *as_rows(int64_t n, int64_t m, const double *matrix, wide_t **at)
{
    double *made = (double *)*at;
    const int64_t whole = ROWS * blocks(m);
    *at += n * blocks(m);
    for (int64_t i = 0; matrix && i < n; i++)
        for (int64_t j = 0; j < whole; j++) made[i * whole + j] = j < m ? matrix[i * m + j] : 0.0;
    return (wide_t *)made;
}

static void give_back(int64_t n, const wide_t *from, double *to)
{
    for (int64_t i = 0; to && i < n; i++) to[i] = ((const double *)from)[i];
}
#endif

static room_t laid_out(const system_t *s, const drive_t *drive, const torques_t *y, state_t *state, samples_t *out,
                       double *room)
{
    const int64_t n = s->n, nf = s->n_forces, modes = blocks(n), forces = blocks(nf), motors = blocks(drive->n_motors);
    wide_t *at = (wide_t *)room;
    room_t w = {.modes = modes, .forces = forces, .motors = motors, .outputs = blocks(y->n), .free = at,
                .forced = at + 4 * modes};
    wide_t **of_modes[] = {&w.base_q, &w.base_v, &w.u, &w.r, &w.q1, &w.v1, &w.a1};
    at += 12 * modes;
    for (int i = 0; i < 7; i++, at += modes) *of_modes[i] = at;
    w.speed = at;
    w.acceleration = at + forces;
    at += 2 * forces;
    w.read = at;
    w.read_rate = at + motors;
    at += 2 * motors;
    w.stiffness = as_rows(1, n, s->stiffness, &at);
    w.rate = as_rows(1, n, s->rate, &at);
    w.reach = as_rows(nf, n, s->reach, &at);
    w.q = as_rows(1, n, state->q, &at);
    w.v = as_rows(1, n, state->v, &at);
    w.along_forces = as_blocks(nf, n, s->reach, &at);
    w.along_read = as_blocks(drive->n_motors, s->n_read, s->read_speed, &at);
    w.position = as_blocks(y->n, n, y->position, &at);
    w.velocity = as_blocks(y->n, n, y->velocity, &at);
    w.of_force = as_blocks(y->n, nf, y->force, &at);
    w.last = as_blocks(y->n, 1, out->last, &at);
    w.last_rate = as_blocks(y->n, 1, out->last_rate, &at);
    w.before = as_blocks(y->n, 1, out->before, &at);
    w.before_rate = as_blocks(y->n, 1, out->before_rate, &at);
    w.largest = as_blocks(y->n, 1, out->largest, &at);
    w.f1 = (lane_t *)at;
    w.fr1 = w.f1 + nf;
    w.phase1 = w.fr1 + nf;
    w.held = (held_t *)(w.phase1 + drive->n_motors);
    return w;
}

/* State and torques where the caller keeps them. */
static void returned(const room_t *w, const system_t *s, const torques_t *y, state_t *state, samples_t *out)
{
    give_back(s->n, w->q, state->q);
    give_back(s->n, w->v, state->v);
    give_back(y->n, w->last, out->last);
    give_back(y->n, w->last_rate, out->last_rate);
    give_back(y->n, w->before, out->before);
    give_back(y->n, w->before_rate, out->before_rate);
    give_back(y->n, w->largest, out->largest);
}

/* Speeds of stations and dampers, and those at which curves are read. */
static void speeds(const system_t *s, const wide_t *v, const wide_t *a, const room_t *w, wide_t *speed,
                   wide_t *acceleration, wide_t *read, wide_t *read_rate)
{
    along_blocks(s->n, w->forces, w->along_forces, (const lane_t *)v, (const lane_t *)a, speed, acceleration);
    along_blocks(s->n_read, w->motors, w->along_read, (const lane_t *)v, (const lane_t *)a, read, read_rate);
}

static void all_forces(lane_t t, lane_t inside, const lane_t *phase, const wide_t *v, const wide_t *a,
                       const system_t *s, const drive_t *drive, const room_t *w)
{
    const lane_t *speed = (const lane_t *)w->speed, *acceleration = (const lane_t *)w->acceleration;
    const lane_t *read = (const lane_t *)w->read, *read_rate = (const lane_t *)w->read_rate;
    machine_forces(drive, s->n_forces, t, inside, phase, speed, acceleration, read, read_rate, w->held, w->f1, w->fr1);
    swing_forces(s, drive, (const lane_t *)v, (const lane_t *)a, read, read_rate, w->f1, w->fr1);
    damper_forces(s->n_dampers, s->damper_force, s->viscous, speed, acceleration, w->f1, w->fr1);
}

/* u and r: what forces and their rates do to each mode. */
static void modal_forces(int64_t n_forces, const lane_t *force, const lane_t *force_rate, const room_t *w)
{
    const int64_t modes = w->modes;
    const wide_t *reach = w->reach;
    wide_t *u = w->u, *r = w->r;
    for (int64_t i = 0; i < modes; i++) {
        wide_t x = spread(all(0.0)), y = x;
        for (int64_t f = 0; f < n_forces; f++) {
            x += reach[f * modes + i] * force[f];
            y += reach[f * modes + i] * force_rate[f];
        }
        u[i] = x;
        r[i] = y;
    }
}

/* a1: accelerations with the forces u in the state q, v. */
static void accelerations(const wide_t *q, const wide_t *v, const room_t *w)
{
    for (int64_t i = 0; i < w->modes; i++) w->a1[i] = w->u[i] - w->rate[i] * v[i] - w->stiffness[i] * q[i];
}

/* Copies the lanes that are named; a single one always is. */
static inline void keep(int64_t n, const lane_t *from, mask_t named, double *to)
{
    for (int64_t i = 0; i < n; i++) ((lane_t *)to)[i] = LANES == 1 ? from[i] : choose(named, from[i], lanes_of(to)[i]);
}

static inline void keep_wide(int64_t n, const wide_t *from, mask_t named, wide_t *to)
{
#if LANES == 1
    for (int64_t i = 0; i < n; i++) to[i] = from[i];
#else
    keep(n, from, named, (double *)to);
#endif
}

/* Forces and their rates in the state of the lanes that are named; the rates depend on the acceleration that the
 * forces cause. */
static void renew_forces(lane_t t, lane_t inside, mask_t renewed, const system_t *s, const drive_t *drive,
                         state_t *state, const room_t *w)
{
    const wide_t none = spread(all(0.0));
    speeds(s, w->v, w->v, w, w->speed, w->acceleration, w->read, w->read_rate);
    for (int64_t f = 0; f < w->forces; f++) w->acceleration[f] = none;
    for (int64_t m = 0; m < w->motors; m++) w->read_rate[m] = none;
    for (int64_t i = 0; i < w->modes; i++) w->a1[i] = none;
    for (int pass = 0; pass < 2; pass++) {
        all_forces(t, inside, lanes_of(state->phase), w->v, w->a1, s, drive, w);
        modal_forces(s->n_forces, w->f1, w->fr1, w);
        for (int64_t i = 0; i < w->modes; i++)
            w->a1[i] = -w->rate[i] * w->v[i] - w->stiffness[i] * w->q[i] + w->u[i];
        speeds(s, w->a1, w->a1, w, w->acceleration, w->acceleration, w->read_rate, w->read_rate);
    }
    keep(s->n_forces, w->f1, renewed, state->force);
    keep(s->n_forces, w->fr1, renewed, state->force_rate);
}

/* One step: predict and evaluate, correct and evaluate. */
static void take_step(lane_t t, lane_t h, const system_t *s, const drive_t *drive, const state_t *state,
                      const room_t *w)
{
    const step_t step = {w->free, w->forced};
    const lane_t *q0 = (const lane_t *)w->q, *q1 = (const lane_t *)w->q1;
    modal_forces(s->n_forces, lanes_of(state->force), lanes_of(state->force_rate), w);
    begin_step(w->modes, &step, h, w->q, w->v, w->u, w->r, w->base_q, w->base_v);
    for (int pass = 0; pass < 2; pass++) {
        end_step(w->modes, &step, w->stiffness, w->rate, w->base_q, w->base_v, w->u, w->r, w->q1, w->v1, w->a1);
        speeds(s, w->v1, w->a1, w, w->speed, w->acceleration, w->read, w->read_rate);
        turn_phases(drive, s->n, lanes_of(s->reach), h, q0, q1, lanes_of(state->phase), w->phase1);
        all_forces(t + h, t + 0.5 * h, w->phase1, w->v1, w->a1, s, drive, w);
        if (pass == 0) modal_forces(s->n_forces, w->f1, w->fr1, w);
    }
}

/* Takes the end of a step as the new state; the mean speed. */
static lane_t accept(const system_t *s, const drive_t *drive, state_t *state, const room_t *w, mask_t goes_on)
{
    lane_t mean = all(0.0);
    const int64_t n = s->n;
    const lane_t *share = lanes_of(s->mean_speed), *v = (const lane_t *)w->v1;
    for (int64_t i = 0; i < n; i++) mean += share[i] * v[i];
    for (int64_t m = 0; m < drive->n_motors; m++) w->phase1[m] = in_turns(w->phase1[m]);
    keep_wide(w->modes, w->q1, goes_on, w->q);
    keep_wide(w->modes, w->v1, goes_on, w->v);
    keep(drive->n_motors, w->phase1, goes_on, state->phase);
    keep(s->n_forces, w->f1, goes_on, state->force);
    keep(s->n_forces, w->fr1, goes_on, state->force_rate);
    return mean;
}

/* Blocks of torques that are summed side by side. */
enum { BLOCKS_AT_ONCE = 4 };

/* Torques of some blocks from one on and their rates, with the forces f. */
static void torques_of(int64_t b, int64_t count, int has_velocity, const system_t *s, const lane_t *f, const lane_t *fr,
                       const room_t *w, wide_t *torque, wide_t *rate)
{
    const int64_t n = s->n, nf = s->n_forces;
    const lane_t *q = (const lane_t *)w->q, *v = (const lane_t *)w->v, *a = (const lane_t *)w->a1;
    wide_t more[2][2][BLOCKS_AT_ONCE]; /* of forces, of velocities */
    const int parts = has_velocity ? 2 : 1;
    along_blocks(n, count, w->position + b * n, q, v, torque, rate);
    along_blocks(nf, count, w->of_force + b * nf, f, fr, more[0][0], more[0][1]);
    if (has_velocity) along_blocks(n, count, w->velocity + b * n, v, a, more[1][0], more[1][1]);
    for (int part = 0; part < parts; part++)
        for (int64_t k = 0; k < count; k++) {
            torque[k] += more[part][0][k];
            rate[k] += more[part][1][k];
        }
}

/* Turning points of a block of n torques between the row before and this one. */
static void record_turning(samples_t *out, int64_t b, int64_t n, mask_t goes_on, lane_t time, wide_t torque,
                           wide_t rate, const room_t *w)
{
    const lane_t before = lanes_of(out->last_time)[0];
    const wide_t h = spread(time - before), y = w->last[b], rate0 = w->last_rate[b], rise = torque - y;
    turning_t turning;
    if (!any_wide(may_turn(h, rise, rate0, rate) & goes_on)) return; /* an idle lane stands */
    turning = turning_of_step(spread(before), h, y, rise, rate0, rate);
    for (int l = 0; l < WIDTH; l++) { /* written without asking: what does not count is written over */
        int64_t *count = out->count + b * WIDTH + l, k;
        if (ROWS > 1 && l == n) break; /* what follows fills the block */
        k = *count;
        double *when = out->when + (b * WIDTH + l) * out->room, *value = out->value + (b * WIDTH + l) * out->room;
        for (int j = 0; j < 2; j++) {
            when[k] = IN(turning.when[j], l);
            value[k] = IN(turning.value[j], l);
            k += IN(turning.is[j], l) != 0;
        }
        *count = AT(goes_on, l) ? k : *count;
    }
}

/* Row k: times, speeds, torques, and where they turned since the row before. */
static void record(samples_t *out, int64_t k, lane_t time, lane_t mean, const torques_t *y, const system_t *s,
                   const state_t *state, mask_t goes_on, int first, const room_t *w)
{
    const lane_t *f = lanes_of(state->force), *fr = lanes_of(state->force_rate);
    wide_t torques[BLOCKS_AT_ONCE], rates[BLOCKS_AT_ONCE];
    if (y->velocity) { /* the acceleration with the forces at the end of the step */
        modal_forces(s->n_forces, f, fr, w);
        accelerations(w->q, w->v, w);
    }
    ((lane_t *)out->time)[k] = time;
    ((lane_t *)out->speed)[k] = mean;
    for (int64_t b = 0, end = w->outputs; b < end; b++) {
        const int64_t at = b % BLOCKS_AT_ONCE, left = end - b;
        const int64_t n = y->n - b * ROWS < ROWS ? y->n - b * ROWS : ROWS; /* of this block */
        if (at == 0)
            torques_of(b, left < BLOCKS_AT_ONCE ? left : BLOCKS_AT_ONCE, y->velocity != NULL, s, f, fr, w, torques,
                       rates);
        for (int64_t r = 0; out->torque && r < n; r++) {
            const int64_t row = (b * ROWS + r) * out->rows + k;
            ((lane_t *)out->torque)[row] = ((const lane_t *)(torques + at))[r];
            ((lane_t *)out->torque_rate)[row] = ((const lane_t *)(rates + at))[r];
        }
        if (out->room == 0) continue;
        if (!first) record_turning(out, b, n, goes_on, time, torques[at], rates[at], w);
        w->largest[b] = choose_wide(magnitude_wide(torques[at]) > w->largest[b], magnitude_wide(torques[at]), w->largest[b]);
        keep_wide(1, w->last + b, goes_on, w->before + b);
        keep_wide(1, w->last_rate + b, goes_on, w->before_rate + b);
        keep_wide(1, torques + at, goes_on, w->last + b);
        keep_wide(1, rates + at, goes_on, w->last_rate + b);
    }
    if (out->room) keep(1, &time, goes_on, out->last_time);
}

/* Forces at rest, and the first row. */
static void BEGIN(const system_t *system, const drive_t *drive, const torques_t *torques, state_t *state, samples_t *out,
           double *room)
{
    const room_t w = laid_out(system, drive, torques, state, out, room);
    lane_t mean = all(0.0);
    const mask_t every = all(0.0) == 0.0;
    hold_none(drive, w.held);
    renew_forces(all(0.0), all(0.0), every, system, drive, state, &w);
    for (int64_t i = 0; i < system->n; i++) mean += lanes_of(system->mean_speed)[i] * lanes_of(state->v)[i];
    record(out, 0, all(0.0), mean, torques, system, state, every, 1, &w);
    returned(&w, system, torques, state, out);
    out->next = 1;
}

/* Coefficients of the steps of one lane. */
static void new_step(double h, int64_t newmark, int l, const room_t *w)
{
    for (int64_t i = 0; i < ROWS * w->modes; i++) {
        double stiffness = ((double *)w->stiffness)[i * LANES + l], rate = ((double *)w->rate)[i * LANES + l];
        map_t map = {{{1.0, 0.0}, {0.0, 1.0}}, {{0.0}}}; /* of a lane that has ended: it stands */
        if (h > 0.0) map = (newmark ? newmark_map : exponential_map)(stiffness, rate, h);
        put_map(&map, ROWS * w->modes, i, LANES, l, (double *)w->free, (double *)w->forced);
    }
}

/* The next stretch of a lane, if its present one is done; 0 where there is none. */
static int on_stretch(stretches_t *plan, int l)
{
    const int64_t *counts = plan->counts + l * plan->most;
    while (plan->at[l] < plan->n[l] && plan->taken[l] == counts[plan->at[l]]) {
        plan->time[l] += plan->steps[l * plan->most + plan->at[l]] * (double)plan->taken[l];
        plan->at[l]++;
        plan->taken[l] = 0;
    }
    if (plan->at[l] == plan->n[l]) plan->reason[l] = AT_TIME;
    return plan->reason[l] == MORE;
}

/* A turning point of some torque more has no room. */
static int full(const samples_t *out, const torques_t *torques)
{
    for (int64_t k = 0; out->room && k < torques->n * LANES; k++)
        if (out->count[k] > out->room - 2) return 1;
    return 0;
}

/* Where each lane is on its stretch; one that has ended has no step. */
typedef struct { lane_t begin, h, taken, count, target; mask_t goes_on; } progress_t;

/* Progress as the caller keeps it; so many rows hold samples. */
static void put_down(const progress_t *p, int64_t rows, stretches_t *plan)
{
    for (int l = 0; l < LANES; l++) {
        if (!AT(p->goes_on, l)) continue;
        plan->taken[l] = (int64_t)AT(p->taken, l);
        plan->done[l] = rows;
    }
}

/* Every lane on the stretch that it has to take, with the coefficients of its steps; `step`: of those at hand. */
static progress_t taken_up(stretches_t *plan, double *step, const room_t *w)
{
    progress_t p = {.count = all(-1.0)};
    for (int l = 0; l < LANES; l++) {
        if (plan->reason[l] == MORE && on_stretch(plan, l)) {
            const int64_t k = l * plan->most + plan->at[l];
            AT(p.goes_on, l) = -1;
            AT(p.begin, l) = plan->time[l];
            AT(p.h, l) = plan->steps[k];
            AT(p.taken, l) = (double)plan->taken[l];
            AT(p.count, l) = (double)plan->counts[k];
        }
        AT(p.target, l) = plan->target_speed[l];
        if (AT(p.h, l) != step[l]) new_step(step[l] = AT(p.h, l), plan->newmark, l, w);
    }
    return p;
}

/* Steps of every lane until its end or its mean speed is reached, or until the output is full. */
static void ADVANCE(stretches_t *plan, const system_t *system, const drive_t *drive, const torques_t *torques,
             state_t *state, samples_t *out, double *room)
{
    const room_t w = laid_out(system, drive, torques, state, out, room);
    double step[LANES];
    progress_t p = {.goes_on = NO_LANE};
    int64_t k = out->next;
    int changes = 1;
    for (int l = 0; l < LANES; l++) step[l] = -1.0;
    hold_none(drive, w.held);
    for (; k < out->rows; k++) {
        mask_t renewed = NO_LANE, reached;
        lane_t t, mean;
        if (changes || any(p.goes_on & (p.taken == p.count))) {
            put_down(&p, k, plan);
            p = taken_up(plan, step, &w);
            renewed = p.goes_on & (p.taken == 0.0);
            changes = 0;
        }
        if (!any(p.goes_on) || full(out, torques)) break;
        t = p.begin + p.h * p.taken;
        if (any(renewed)) renew_forces(t, t + 0.5 * p.h, renewed, system, drive, state, &w);
        take_step(t, p.h, system, drive, state, &w);
        mean = accept(system, drive, state, &w, p.goes_on);
        p.taken += 1.0;
        record(out, k, p.begin + p.h * p.taken, mean, torques, system, state, p.goes_on, 0, &w);
        reached = p.goes_on & (mean >= p.target);
        for (int l = 0; any(reached) && l < LANES; l++)
            if (AT(reached, l)) plan->reason[l] = SPEED;
        changes = any(reached);
    }
    out->next = k;
    put_down(&p, k, plan);
    returned(&w, system, torques, state, out);
}
