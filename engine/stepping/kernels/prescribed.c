/* Trains under prescribed torques, which are polynomials over each step. */
#include "step.h"
#include "vector_units.h"

/* Modes that are calculated side by side, a register each SOME: two steps of a mode wait for each other, those of
 * others do not. */
enum { SOME = 4, REGISTERS = 2, MODES = SOME * REGISTERS };
typedef double some_t __attribute__((vector_size(8 * SOME), aligned(8), may_alias));
typedef struct { some_t of[REGISTERS]; } modes_t;

int64_t prescribed_room(const prescribed_t *p) { return 2 * MODES * p->n_torques * p->terms; }

/* Coefficients of a step of the modes from `from` on: of their state (4), and of the torques' coefficients, what each
 * adds to positions and to velocities (terms, n_torques, 2). */
static void step_of(const prescribed_t *p, int64_t from, int64_t here, double h, modes_t *free, modes_t *push)
{
    for (int64_t w = 0; w < here; w++) {
        const int64_t i = from + w;
        const map_t map = polynomial_map(p->stiffness[i], p->rate[i], h);
        double *own = (double *)free + w, *given = (double *)push + w;
        for (int j = 0; j < 4; j++) own[MODES * j] = map.free[j / 2][j % 2];
        for (int64_t j = 0; j < p->terms; j++)
            for (int64_t s = 0; s < p->n_torques; s++)
                for (int x = 0; x < 2; x++, given += MODES) *given = p->reach[i * p->n_torques + s] * map.forced[x][j];
    }
}

/* Some modes over all steps; their states are written a few steps at a time, in the order of time. */
IN_BOTH void drive_some(const prescribed_t *p, int64_t from, int64_t n_steps, const double *steps,
                        const double *torque, double *q, double *v, int64_t n_times, double *out,
                        modes_t *push)
{
    const int64_t here = p->n - from < MODES ? p->n - from : MODES, n_push = p->n_torques * p->terms;
    modes_t free[4] = {{{{0.0}}}}, xs[MODES] = {{{{0.0}}}}, ys[MODES] = {{{{0.0}}}}, x, y;
    double *written_x = (double *)xs, *written_y = (double *)ys;
    for (int64_t j = 0; j < 2 * n_push; j++) push[j] = xs[0];
    for (int64_t w = 0; w < here; w++) written_x[w] = q[from + w], written_y[w] = v[from + w];
    x = xs[0], y = ys[0];
    for (int64_t k = 0, n = 0; k < n_steps; k++) {
        if (k == 0 || steps[k] != steps[k - 1]) step_of(p, from, here, steps[k], free, push);
        for (int r = 0; r < REGISTERS; r++) {
            some_t pushed = {0.0}, sped = {0.0}, before = x.of[r];
            for (int64_t j = 0; j < n_push; j++) {
                pushed += push[2 * j].of[r] * torque[j * n_steps + k];
                sped += push[2 * j + 1].of[r] * torque[j * n_steps + k];
            }
            x.of[r] = free[0].of[r] * before + free[1].of[r] * y.of[r] + pushed;
            y.of[r] = free[2].of[r] * before + free[3].of[r] * y.of[r] + sped;
        }
        xs[n] = x;
        ys[n++] = y;
        if (n < MODES && k + 1 < n_steps) continue;
        for (int64_t w = 0; w < here; w++)
            for (double *at = out + 2 * (from + w) * n_times + k + 1 - n, *i = at; i < at + n; i++)
                i[0] = written_x[MODES * (i - at) + w], i[n_times] = written_y[MODES * (i - at) + w];
        n = 0;
    }
    xs[0] = x, ys[0] = y;
    for (int64_t w = 0; w < here; w++) q[from + w] = written_x[w], v[from + w] = written_y[w];
}

static void drive_plain(const prescribed_t *p, int64_t from, int64_t n_steps, const double *steps,
                        const double *torque, double *q, double *v, int64_t n_times, double *out,
                        modes_t *push)
{
    drive_some(p, from, n_steps, steps, torque, q, v, n_times, out, push);
}

static WIDER void drive_wide(const prescribed_t *p, int64_t from, int64_t n_steps, const double *steps,
                             const double *torque, double *q, double *v, int64_t n_times, double *out,
                             modes_t *push)
{
    drive_some(p, from, n_steps, steps, torque, q, v, n_times, out, push);
}

/* torque: (terms, n_torques, n_steps). The states after the steps are written into (n, 2, n_times), from time `first` on. */
void drive_modes(const prescribed_t *p, int64_t n_steps, const double *steps, const double *torque, double *q,
                 double *v, int64_t n_times, int64_t first, double *out, double *room)
{
    for (int64_t from = 0; from < p->n; from += MODES)
        (has_wider() ? drive_wide : drive_plain)(p, from, n_steps, steps, torque, q, v, n_times, out + first,
                                                (modes_t *)room);
}

/* A coupled linear system; torque: (n_push, n_steps), coefficients of all torques over a step. */
void drive_coupled(int64_t n_steps, int64_t n_state, int64_t n_push, const double *free, const double *push,
                   const double *torque, double *state, double *out, double *room)
{
    for (int64_t k = 0; k < n_steps; k++) {
        for (int64_t i = 0; i < n_state; i++) {
            const double *row = free + i * n_state, *pushed = push + i * n_push;
            double x = 0.0;
            for (int64_t j = 0; j < n_state; j++) x += row[j] * state[j];
            for (int64_t j = 0; j < n_push; j++) x += pushed[j] * torque[j * n_steps + k];
            room[i] = x;
        }
        for (int64_t i = 0; i < n_state; i++) state[i] = out[k * n_state + i] = room[i];
    }
}
