/* Starts without events, one a lane: fixed steps under motors and loads. Written once on lane_t; each source that
 * includes it names its two functions, BEGIN and ADVANCE. */
#include "modal.h"
#include "step.h"
#include "turning.h"

/* Room to work in: coefficients of the step, its forces without and with its end, its end. */
typedef struct {
    lane_t *free, *forced, *base_q, *base_v, *u, *r, *q1, *v1, *a1, *f1, *fr1, *speed, *acceleration, *phase1, *read, *read_rate;
    held_t *held;
} room_t;

static room_t laid_out(const system_t *s, const drive_t *drive, double *room)
{
    const int64_t n = s->n, nf = s->n_forces;
    lane_t *at = (lane_t *)room;
    room_t w = {.free = at, .forced = at + 4 * n};
    lane_t **of_modes[] = {&w.base_q, &w.base_v, &w.u, &w.r, &w.q1, &w.v1, &w.a1};
    lane_t **of_forces[] = {&w.f1, &w.fr1, &w.speed, &w.acceleration};
    at += 12 * n;
    for (int i = 0; i < 7; i++, at += n) *of_modes[i] = at;
    for (int i = 0; i < 4; i++, at += nf) *of_forces[i] = at;
    w.phase1 = at;
    w.read = at + drive->n_motors;
    w.read_rate = at + 2 * drive->n_motors;
    w.held = (held_t *)(at + 3 * drive->n_motors);
    return w;
}

/* Speeds of stations and dampers, and those at which curves are read. */
static void speeds(const system_t *s, const drive_t *drive, const lane_t *v, const lane_t *a, const room_t *w)
{
    along_rows(s->n, s->n_forces, NULL, lanes_of(s->reach), v, a, w->speed, w->acceleration);
    along_rows(s->n_read, drive->n_motors, NULL, lanes_of(s->read_speed), v, a, w->read, w->read_rate);
}

static void all_forces(lane_t t, lane_t inside, const lane_t *phase, const lane_t *v, const lane_t *a,
                       const system_t *s, const drive_t *drive, const room_t *w)
{
    machine_forces(drive, s->n_forces, t, inside, phase, w->speed, w->acceleration, w->read, w->read_rate, w->held,
                   w->f1, w->fr1);
    swing_forces(s, drive, v, a, w->read, w->read_rate, w->f1, w->fr1);
    damper_forces(s->n_dampers, s->damper_force, s->viscous, w->speed, w->acceleration, w->f1, w->fr1);
}

/* u and r: what forces and their rates do to each mode. As `to_modes` does it, but mode by mode: where no force is
 * zero, as of lanes, u and r then stay in registers. */
static void modal_forces(const system_t *s, const lane_t *force, const lane_t *force_rate, const room_t *w)
{
    for (int64_t i = 0; i < s->n; i++) {
        const lane_t *row = lanes_of(s->reach) + i;
        lane_t u = all(0.0), r = all(0.0);
        for (int64_t f = 0; f < s->n_forces; f++) {
            u += row[f * s->n] * force[f];
            r += row[f * s->n] * force_rate[f];
        }
        w->u[i] = u;
        w->r[i] = r;
    }
}

/* Forces and their rates in the state of the lanes that are named; the rates depend on the acceleration that the
 * forces cause. */
static void renew_forces(lane_t t, lane_t inside, const int *renewed, const system_t *s, const drive_t *drive,
                         state_t *state, const room_t *w)
{
    const lane_t *q = lanes_of(state->q), *v = lanes_of(state->v);
    speeds(s, drive, v, v, w);
    for (int64_t f = 0; f < s->n_forces; f++) w->acceleration[f] = all(0.0);
    for (int64_t m = 0; m < drive->n_motors; m++) w->read_rate[m] = all(0.0);
    for (int64_t i = 0; i < s->n; i++) w->a1[i] = all(0.0);
    for (int pass = 0; pass < 2; pass++) {
        all_forces(t, inside, lanes_of(state->phase), v, w->a1, s, drive, w);
        modal_forces(s, w->f1, w->fr1, w);
        for (int64_t i = 0; i < s->n; i++)
            w->a1[i] = -lanes_of(s->rate)[i] * v[i] - lanes_of(s->stiffness)[i] * q[i] + w->u[i];
        along_rows(s->n, s->n_forces, NULL, lanes_of(s->reach), w->a1, w->a1, w->acceleration, w->acceleration);
        along_rows(s->n_read, drive->n_motors, NULL, lanes_of(s->read_speed), w->a1, w->a1, w->read_rate, w->read_rate);
    }
    for (int64_t f = 0; f < s->n_forces; f++)
        for (int l = 0; l < LANES; l++) {
            if (!renewed[l]) continue;
            state->force[f * LANES + l] = AT(w->f1[f], l);
            state->force_rate[f * LANES + l] = AT(w->fr1[f], l);
        }
}

/* One step: predict and evaluate, correct and evaluate. */
static void take_step(lane_t t, lane_t h, const system_t *s, const drive_t *drive, const state_t *state,
                      const room_t *w)
{
    const int64_t n = s->n;
    const step_t step = {w->free, w->forced};
    const lane_t *reach = lanes_of(s->reach), *q = lanes_of(state->q), *phase = lanes_of(state->phase);
    modal_forces(s, lanes_of(state->force), lanes_of(state->force_rate), w);
    begin_step(n, &step, h, q, lanes_of(state->v), w->u, w->r, w->base_q, w->base_v);
    for (int pass = 0; pass < 2; pass++) {
        end_step(n, &step, lanes_of(s->stiffness), lanes_of(s->rate), w->base_q, w->base_v, w->u, w->r, w->q1,
                 w->v1, w->a1);
        speeds(s, drive, w->v1, w->a1, w);
        turn_phases(drive, n, reach, h, q, w->q1, phase, w->phase1);
        all_forces(t + h, t + 0.5 * h, w->phase1, w->v1, w->a1, s, drive, w);
        if (pass == 0) modal_forces(s, w->f1, w->fr1, w);
    }
}

/* Copies the lanes that go on. */
static void keep(int64_t n, const lane_t *from, const int *goes_on, int everyone, double *to)
{
    for (int64_t i = 0; everyone && i < n; i++) ((lane_t *)to)[i] = from[i];
    for (int64_t i = 0; !everyone && i < n; i++)
        for (int l = 0; l < LANES; l++)
            if (goes_on[l]) to[i * LANES + l] = AT(from[i], l);
}

/* Takes the end of a step as the new state; the mean speed. */
static lane_t accept(const system_t *s, const drive_t *drive, state_t *state, const room_t *w, const int *goes_on,
                     int everyone)
{
    lane_t mean = all(0.0);
    for (int64_t i = 0; i < s->n; i++) mean += lanes_of(s->mean_speed)[i] * w->v1[i];
    for (int64_t m = 0; m < drive->n_motors; m++) w->phase1[m] = in_turns(w->phase1[m]);
    keep(s->n, w->q1, goes_on, everyone, state->q);
    keep(s->n, w->v1, goes_on, everyone, state->v);
    keep(drive->n_motors, w->phase1, goes_on, everyone, state->phase);
    keep(s->n_forces, w->f1, goes_on, everyone, state->force);
    keep(s->n_forces, w->fr1, goes_on, everyone, state->force_rate);
    return mean;
}

/* Torques that are summed side by side: the sums of one wait for each other. */
enum { TORQUES_AT_ONCE = 4 };

/* Torques i to i + count and their rates in the state q, v with the forces f. */
static void torques_of(const torques_t *y, int64_t i, int64_t count, const system_t *s, const lane_t *q, const lane_t *v,
                       const lane_t *a, const lane_t *f, const lane_t *fr, lane_t *torque, lane_t *rate)
{
    const int64_t n = s->n, nf = s->n_forces;
    lane_t more[2][2][TORQUES_AT_ONCE]; /* of forces, of velocities */
    const int parts = y->velocity ? 2 : 1;
    along_rows(n, count, NULL, lanes_of(y->position) + i * n, q, v, torque, rate);
    along_rows(nf, count, NULL, lanes_of(y->force) + i * nf, f, fr, more[0][0], more[0][1]);
    if (y->velocity) along_rows(n, count, NULL, lanes_of(y->velocity) + i * n, v, a, more[1][0], more[1][1]);
    for (int part = 0; part < parts; part++)
        for (int64_t k = 0; k < count; k++) {
            torque[k] += more[part][0][k];
            rate[k] += more[part][1][k];
        }
}

/* Turning points of a torque between the row before and this one. */
static void record_turning(samples_t *out, int64_t i, const int *goes_on, lane_t time, lane_t torque, lane_t rate)
{
    const lane_t before = lanes_of(out->last_time)[0], y = lanes_of(out->last)[i];
    const lane_t rate0 = lanes_of(out->last_rate)[i], h = time - before, rise = torque - y;
    turning_t turning;
    if (!any(may_turn(h, rise, rate0, rate))) return;
    turning = turning_of_step(before, h, y, rise, rate0, rate);
    for (int l = 0; l < LANES; l++) { /* written without asking: what does not count is written over */
        int64_t *count = out->count + i * LANES + l, k = *count;
        double *when = out->when + (i * LANES + l) * out->room, *value = out->value + (i * LANES + l) * out->room;
        for (int j = 0; j < 2; j++) {
            when[k] = AT(turning.when[j], l);
            value[k] = AT(turning.value[j], l);
            k += AT(turning.is[j], l) != 0;
        }
        *count = goes_on[l] ? k : *count;
    }
}

/* Row k: times, speeds, torques, and where they turned since the row before. */
static void record(samples_t *out, int64_t k, lane_t time, lane_t mean, const torques_t *y, const system_t *s,
                   const state_t *state, const int *goes_on, int everyone, int first, const room_t *w)
{
    const lane_t *q = lanes_of(state->q), *v = lanes_of(state->v);
    const lane_t *f = lanes_of(state->force), *fr = lanes_of(state->force_rate);
    lane_t torques[TORQUES_AT_ONCE], rates[TORQUES_AT_ONCE];
    if (y->velocity) { /* the acceleration with the forces at the end of the step */
        modal_forces(s, f, fr, w);
        for (int64_t i = 0; i < s->n; i++)
            w->a1[i] = w->u[i] - lanes_of(s->rate)[i] * v[i] - lanes_of(s->stiffness)[i] * q[i];
    }
    ((lane_t *)out->time)[k] = time;
    ((lane_t *)out->speed)[k] = mean;
    for (int64_t i = 0; i < y->n; i++) {
        const int64_t at = i % TORQUES_AT_ONCE, left = y->n - i, count = left < TORQUES_AT_ONCE ? left : TORQUES_AT_ONCE;
        lane_t torque, rate, *largest = (lane_t *)out->largest + i;
        if (at == 0) torques_of(y, i, count, s, q, v, w->a1, f, fr, torques, rates);
        torque = torques[at];
        rate = rates[at];
        if (out->torque) {
            ((lane_t *)out->torque)[i * out->rows + k] = torque;
            ((lane_t *)out->torque_rate)[i * out->rows + k] = rate;
        }
        if (out->room == 0) continue;
        if (!first) record_turning(out, i, goes_on, time, torque, rate);
        *largest = choose(magnitude(torque) > *largest, magnitude(torque), *largest);
        keep(1, lanes_of(out->last) + i, goes_on, everyone, out->before + i * LANES);
        keep(1, lanes_of(out->last_rate) + i, goes_on, everyone, out->before_rate + i * LANES);
        keep(1, &torque, goes_on, everyone, out->last + i * LANES);
        keep(1, &rate, goes_on, everyone, out->last_rate + i * LANES);
    }
    if (out->room) keep(1, &time, goes_on, everyone, out->last_time);
}

/* Forces at rest, and the first row. */
static void BEGIN(const system_t *system, const drive_t *drive, const torques_t *torques, state_t *state, samples_t *out,
           double *room)
{
    const room_t w = laid_out(system, drive, room);
    lane_t mean = all(0.0);
    int every[LANES];
    for (int l = 0; l < LANES; l++) every[l] = 1;
    hold_none(drive, w.held);
    renew_forces(all(0.0), all(0.0), every, system, drive, state, &w);
    for (int64_t i = 0; i < system->n; i++) mean += lanes_of(system->mean_speed)[i] * lanes_of(state->v)[i];
    record(out, 0, all(0.0), mean, torques, system, state, every, 1, 1, &w);
    out->next = 1;
}

/* Coefficients of the steps of one lane. */
static void new_step(double h, int64_t newmark, const system_t *s, int l, const room_t *w)
{
    for (int64_t i = 0; i < s->n; i++) {
        double stiffness = s->stiffness[i * LANES + l], rate = s->rate[i * LANES + l];
        map_t map = (newmark ? newmark_map : exponential_map)(stiffness, rate, h);
        put_map(&map, s->n, i, LANES, l, (double *)w->free, (double *)w->forced);
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

/* Steps of every lane until its end or its mean speed is reached, or until the output is full. */
static void ADVANCE(stretches_t *plan, const system_t *system, const drive_t *drive, const torques_t *torques,
             state_t *state, samples_t *out, double *room)
{
    const room_t w = laid_out(system, drive, room);
    double step[LANES] = {0.0}; /* of the coefficients at hand */
    hold_none(drive, w.held);
    for (int64_t k = out->next; k < out->rows; out->next = ++k) {
        int goes_on[LANES], renewed[LANES], running = 0, renews = 0;
        lane_t t = all(0.0), h = all(1.0), mean, time;
        for (int l = 0; l < LANES; l++) {
            goes_on[l] = plan->reason[l] == MORE && on_stretch(plan, l);
            renewed[l] = goes_on[l] && plan->taken[l] == 0;
            running += goes_on[l];
            renews |= renewed[l];
            if (!goes_on[l]) continue;
            AT(h, l) = plan->steps[l * plan->most + plan->at[l]];
            AT(t, l) = plan->time[l] + AT(h, l) * (double)plan->taken[l];
            if (AT(h, l) != step[l]) new_step(step[l] = AT(h, l), plan->newmark, system, l, &w);
        }
        if (!running || full(out, torques)) return;
        if (renews) renew_forces(t, t + 0.5 * h, renewed, system, drive, state, &w);
        take_step(t, h, system, drive, state, &w);
        mean = accept(system, drive, state, &w, goes_on, running == LANES);
        time = t;
        for (int l = 0; l < LANES; l++)
            if (goes_on[l]) AT(time, l) = plan->time[l] + AT(h, l) * (double)++plan->taken[l];
        record(out, k, time, mean, torques, system, state, goes_on, running == LANES, 0, &w);
        for (int l = 0; l < LANES; l++) {
            if (!goes_on[l]) continue;
            plan->done[l] = k + 1;
            if (AT(mean, l) >= plan->target_speed[l]) plan->reason[l] = SPEED;
        }
    }
}
