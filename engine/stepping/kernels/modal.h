/* What both loops do with modes: forces to modes, motion of forces, one step. */
#ifndef TORSION_MODAL_H
#define TORSION_MODAL_H
#include "forces.h"

/* Coefficients of one step, the modes along the last axis: (2, 2, n) and (2, 4, n). */
typedef struct { const double *free, *forced; } step_t;

/* u += reachᵀ force and r += reachᵀ force_rate. */
static inline void to_modes(int64_t n, int64_t n_forces, const double *reach, const double *force,
                            const double *force_rate, double *restrict u, double *restrict r)
{
    for (int64_t f = 0; f < n_forces; f++) {
        const double *row = reach + f * n;
        double a = force[f], b = force_rate[f];
        if (a == 0.0 && b == 0.0) continue; /* most flanks, most of the time */
        for (int64_t i = 0; i < n; i++) {
            u[i] += row[i] * a;
            r[i] += row[i] * b;
        }
    }
}

/* Sums of two motions along a row, in the order of the modes. */
static inline void along(int64_t n, const double *row, const double *v, const double *a, double *speed,
                         double *acceleration)
{
    double x = 0.0, y = 0.0;
    for (int64_t i = 0; i < n; i++) {
        x += row[i] * v[i];
        y += row[i] * a[i];
    }
    *speed = x;
    *acceleration = y;
}

/* The same along some rows, four at a time: the sums of one row wait for each other, those of four do not. */
static inline void along_rows(int64_t n, int64_t n_rows, const int64_t *which, const double *rows,
                              const double *v, const double *a, double *speed, double *acceleration)
{
    int64_t f = 0;
    for (; f + 4 <= n_rows; f += 4) {
        const double *p = rows + which[f] * n, *q = rows + which[f + 1] * n;
        const double *r = rows + which[f + 2] * n, *s = rows + which[f + 3] * n;
        double x[4] = {0.0}, y[4] = {0.0};
        for (int64_t i = 0; i < n; i++) {
            x[0] += p[i] * v[i];
            y[0] += p[i] * a[i];
            x[1] += q[i] * v[i];
            y[1] += q[i] * a[i];
            x[2] += r[i] * v[i];
            y[2] += r[i] * a[i];
            x[3] += s[i] * v[i];
            y[3] += s[i] * a[i];
        }
        for (int k = 0; k < 4; k++) {
            speed[which[f + k]] = x[k];
            acceleration[which[f + k]] = y[k];
        }
    }
    for (; f < n_rows; f++)
        along(n, rows + which[f] * n, v, a, speed + which[f], acceleration + which[f]);
}

/* What does not depend on the end of the step; u becomes the force at its end if the rates stood. */
static inline void begin_step(int64_t n, const step_t *s, double h, const double *restrict q,
                              const double *restrict v, double *restrict u, const double *restrict r,
                              double *restrict base_q, double *restrict base_v)
{
    const double *a = s->free, *b = s->forced;
    for (int64_t i = 0; i < n; i++) {
        base_q[i] = a[i] * q[i] + a[n + i] * v[i] + b[i] * u[i] + b[n + i] * r[i];
        base_v[i] = a[2 * n + i] * q[i] + a[3 * n + i] * v[i] + b[4 * n + i] * u[i] + b[5 * n + i] * r[i];
        u[i] += h * r[i];
    }
}

/* The end of the step with the forces u and their rates r there. */
static inline void end_step(int64_t n, const step_t *s, const double *restrict stiffness,
                            const double *restrict rate, const double *restrict base_q,
                            const double *restrict base_v, const double *restrict u,
                            const double *restrict r, double *restrict q, double *restrict v,
                            double *restrict a)
{
    const double *b = s->forced;
    for (int64_t i = 0; i < n; i++) {
        q[i] = base_q[i] + b[2 * n + i] * u[i] + b[3 * n + i] * r[i];
        v[i] = base_v[i] + b[6 * n + i] * u[i] + b[7 * n + i] * r[i];
        a[i] = u[i] - rate[i] * v[i] - stiffness[i] * q[i];
    }
}

/* Phase of each pulsation at the end of the step. */
static inline void turn_phases(const drive_t *d, int64_t n, const double *reach, double h,
                               const double *q0, const double *q1, const double *phase, double *phase1)
{
    for (int64_t m = 0; m < d->n_motors; m++) {
        const double *row = reach + d->motor_force[m] * n;
        double turned = 0.0;
        for (int64_t i = 0; i < n; i++) turned += row[i] * (q1[i] - q0[i]);
        phase1[m] = phase[m] + 2.0 * (d->line_omega * h - d->pole_pairs[m] * turned);
    }
}
#endif
