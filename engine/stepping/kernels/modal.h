/* What the loops do with modes: forces to modes, motion of forces, one step. */
#ifndef TORSION_MODAL_H
#define TORSION_MODAL_H
#include "forces.h"

/* Coefficients of one step, the modes along the last axis: (2, 2, n) and (2, 4, n). */
typedef struct { const wide_t *free, *forced; } step_t;

/* u += reachᵀ force and r += reachᵀ force_rate. */
static inline void to_modes(int64_t n, int64_t n_forces, const lane_t *reach, const lane_t *force,
                            const lane_t *force_rate, lane_t *restrict u, lane_t *restrict r)
{
    for (int64_t f = 0; f < n_forces; f++) {
        const lane_t *row = reach + f * n;
        const lane_t a = force[f], b = force_rate[f];
        if (!any((a != 0.0) | (b != 0.0))) continue; /* most flanks, most of the time */
        for (int64_t i = 0; i < n; i++) {
            u[i] += row[i] * a;
            r[i] += row[i] * b;
        }
    }
}

/* Sums of two motions along a row, in the order of the modes. */
static inline void along(int64_t n, const lane_t *row, const lane_t *v, const lane_t *a, lane_t *speed,
                         lane_t *acceleration)
{
    lane_t x = all(0.0), y = all(0.0);
    for (int64_t i = 0; i < n; i++) {
        x += row[i] * v[i];
        y += row[i] * a[i];
    }
    *speed = x;
    *acceleration = y;
}

/* The same along the ROWS rows of each block: (n_blocks, n, ROWS; lanes). Two blocks at once where there are two: the
 * sums of one wait for each other. */
static inline void along_blocks(int64_t n, int64_t n_blocks, const wide_t *blocks, const lane_t *v, const lane_t *a,
                                wide_t *speed, wide_t *acceleration)
{
    int64_t b = 0;
    for (; b + 2 <= n_blocks; b += 2) {
        const wide_t *row = blocks + b * n, *next = row + n;
        wide_t x = spread(all(0.0)), y = x, z = x, w = x;
        for (int64_t i = 0; i < n; i++) {
            x += row[i] * v[i];
            y += row[i] * a[i];
            z += next[i] * v[i];
            w += next[i] * a[i];
        }
        speed[b] = x;
        acceleration[b] = y;
        speed[b + 1] = z;
        acceleration[b + 1] = w;
    }
    for (; b < n_blocks; b++) {
        const wide_t *row = blocks + b * n;
        wide_t x = spread(all(0.0)), y = x;
        for (int64_t i = 0; i < n; i++) {
            x += row[i] * v[i];
            y += row[i] * a[i];
        }
        speed[b] = x;
        acceleration[b] = y;
    }
}

/* What motors answer to small oscillations of each mode, by tables against the speed at which their curves are read:
 * straight between its levels, constant outside. */
static inline void swing_forces(const system_t *s, const drive_t *d, const lane_t *v, const lane_t *a,
                                const lane_t *read, const lane_t *read_rate, lane_t *force, lane_t *force_rate)
{
    for (int64_t k = 0; k < s->n_swings; k++) {
        const int64_t m = s->swing_motor[k], f = d->motor_force[m], n = s->n, last = s->n_levels - 1;
        if (d->connected[m * LANES] == 0.0) continue; /* in all lanes */
        for (int l = 0; l < LANES; l++) {
            const double scale = (double)last / d->motor_speed[m * LANES + l], x = scale * AT(read[m], l);
            const int inside = x > 0.0 && x < (double)last;
            const int64_t low = inside ? (int64_t)x : x > 0.0 ? last - 1 : 0;
            const double share = inside ? x - (double)low : x > 0.0 ? 1.0 : 0.0;
            const double moves = inside ? scale * AT(read_rate[m], l) : 0.0;
            const double *row = s->swing + ((k * s->n_levels + low) * n) * LANES + l, *next = row + n * LANES;
            double value = 0.0, rate = 0.0;
            for (int64_t i = 0; i < n; i++) {
                const double rise = next[i * LANES] - row[i * LANES], gain = row[i * LANES] + share * rise;
                value += gain * AT(v[i], l);
                rate += gain * AT(a[i], l) + rise * moves * AT(v[i], l);
            }
            AT(force[f], l) += value;
            AT(force_rate[f], l) += rate;
        }
    }
}

/* What does not depend on the end of the step; u becomes the force at its end if the rates stood. */
static inline void begin_step(int64_t n, const step_t *s, lane_t h, const wide_t *restrict q,
                              const wide_t *restrict v, wide_t *restrict u, const wide_t *restrict r,
                              wide_t *restrict base_q, wide_t *restrict base_v)
{
    const wide_t *a = s->free, *b = s->forced;
    for (int64_t i = 0; i < n; i++) {
        base_q[i] = a[i] * q[i] + a[n + i] * v[i] + b[i] * u[i] + b[n + i] * r[i];
        base_v[i] = a[2 * n + i] * q[i] + a[3 * n + i] * v[i] + b[4 * n + i] * u[i] + b[5 * n + i] * r[i];
        u[i] += h * r[i];
    }
}

/* The end of the step with the forces u and their rates r there. */
static inline void end_step(int64_t n, const step_t *s, const wide_t *restrict stiffness,
                            const wide_t *restrict rate, const wide_t *restrict base_q,
                            const wide_t *restrict base_v, const wide_t *restrict u,
                            const wide_t *restrict r, wide_t *restrict q, wide_t *restrict v,
                            wide_t *restrict a)
{
    const wide_t *b = s->forced;
    for (int64_t i = 0; i < n; i++) {
        q[i] = base_q[i] + b[2 * n + i] * u[i] + b[3 * n + i] * r[i];
        v[i] = base_v[i] + b[6 * n + i] * u[i] + b[7 * n + i] * r[i];
        a[i] = u[i] - rate[i] * v[i] - stiffness[i] * q[i];
    }
}

/* Phase of each pulsation at the end of the step. */
static inline void turn_phases(const drive_t *d, int64_t n, const lane_t *reach, lane_t h,
                               const lane_t *q0, const lane_t *q1, const lane_t *phase, lane_t *phase1)
{
    for (int64_t m = 0; m < d->n_motors; m++) {
        const lane_t *row = reach + d->motor_force[m] * n;
        lane_t turned = all(0.0);
        for (int64_t i = 0; i < n; i++) turned += row[i] * (q1[i] - q0[i]);
        phase1[m] = phase[m] + 2.0 * (lanes_of(d->line_omega)[m] * h - lanes_of(d->pole_pairs)[m] * turned);
    }
}
#endif
