/* Flux linkages of motors in time: one step beside that of the modes.
 *
 * dψ/dt = A ψ + ω W ψ + ω₀ u + e in the axes of the rotor, whose electrical speed ω and angle are those of its station.
 * A step has values and first two derivatives at both ends (Hermite and Obreshkov: fourth order, A-stable, its error
 * that of the cubic in the step which the modes take torques as):
 *
 *     ψ₁ = ψ₀ + h/2 (ψ'₀ + ψ'₁) + h²/12 (ψ''₀ − ψ''₁)
 *
 * which is linear in ψ₁ where the motion of the rotor is known.
 */
#ifndef TORSION_FLUXES_H
#define TORSION_FLUXES_H
#include "forces.h"

enum { MOST_FLUX = 8 };

/* What acts on the fluxes of a motor at one time: voltages, the electrical speed of its rotor, and their rates. */
typedef struct { double b[MOST_FLUX], rate[MOST_FLUX], speed, speed_rate; } acting_t;

/* Fluxes of a motor and their first two derivatives. */
typedef struct { double psi[MOST_FLUX], slope[MOST_FLUX], curve[MOST_FLUX]; } fluxes_t;

static inline double times_row(int64_t n, const double *row, const double *x)
{
    double sum = 0.0;
    for (int64_t i = 0; i < n; i++) sum += row[i] * x[i];
    return sum;
}

/* Voltage that the line leaves a motor at a speed. */
static inline point_t line_voltage(const drive_t *d, int64_t k, double read, double read_rate)
{
    const machines_t *m = &d->machines;
    const double own = d->motor_speed[m->motor[k]];
    held_t piece;
    double x = read / own;
    if (m->voltage[k] < 0) return (point_t){1.0, 0.0};
    hold(&d->curves, m->voltage[k], 0, x, &piece);
    x -= piece.knot;
    return (point_t){piece.cubic[0] + x * (piece.cubic[1] + x * (piece.cubic[2] + x * piece.cubic[3])),
                     (piece.cubic[1] + x * (2.0 * piece.cubic[2] + 3.0 * x * piece.cubic[3])) * (read_rate / own)};
}

/* `phase` is twice the angle of the line ahead of the rotor; speed and its rate are those of the station. */
static inline void acting(const drive_t *d, int64_t k, double t, double inside, double phase, double speed,
                          double acceleration, double read, double read_rate, acting_t *a)
{
    const machines_t *m = &d->machines;
    const int64_t n = m->n_flux[k], q = m->q[k], motor = m->motor[k];
    const double pairs = d->pole_pairs[motor], line = m->line_omega;
    const point_t v = line_voltage(d, k, read, read_rate);
    const double f = m->forward[2 * k], b = m->backward[2 * k];
    const sincos_t ahead = sin_cos(0.5 * phase + m->forward[2 * k + 1]);
    const sincos_t back = sin_cos(0.5 * phase + m->backward[2 * k + 1] - 2.0 * line * t);
    const double c = f * ahead.cosine + b * back.cosine, s = f * ahead.sine + b * back.sine;
    double turns, turns_back, grown = 1.0, growth = 0.0;
    a->speed = m->frame + pairs * speed;
    a->speed_rate = pairs * acceleration;
    turns = line - a->speed;
    turns_back = -line - a->speed;
    if (inside >= d->field_time[motor] && !isinf(d->field_rate[motor])) {
        const double since = t - d->field_time[motor];
        const double left = exponential(-d->field_rate[motor] * (since > 0.0 ? since : 0.0));
        grown = 1.0 - left;
        growth = d->field_rate[motor] * left;
    }
    for (int64_t i = 0; i < n; i++) {
        a->b[i] = m->field[k * m->most + i] * grown;
        a->rate[i] = m->field[k * m->most + i] * growth;
    }
    a->b[0] += m->stator[k] * line * (v.value * c);
    a->b[q] += m->stator[k] * line * (v.value * s);
    a->rate[0] += m->stator[k] * line
                  * (v.slope * c - v.value * (f * turns * ahead.sine + b * turns_back * back.sine));
    a->rate[q] += m->stator[k] * line
                  * (v.slope * s + v.value * (f * turns * ahead.cosine + b * turns_back * back.cosine));
}

/* out = A x + ω W x. */
static inline void flux_rates(const machines_t *m, int64_t k, double speed, const double *x, double *out)
{
    const int64_t n = m->n_flux[k], q = m->q[k];
    const double w = m->stator[k] * speed;
    for (int64_t i = 0; i < n; i++) out[i] = times_row(n, m->rate + (k * m->most + i) * m->most, x);
    out[0] += w * x[q];
    out[q] -= w * x[0];
}

static inline void derivatives(const machines_t *m, int64_t k, const acting_t *a, fluxes_t *x)
{
    const int64_t n = m->n_flux[k], q = m->q[k];
    const double w = m->stator[k] * a->speed_rate;
    flux_rates(m, k, a->speed, x->psi, x->slope);
    for (int64_t i = 0; i < n; i++) x->slope[i] += a->b[i];
    flux_rates(m, k, a->speed, x->slope, x->curve);
    for (int64_t i = 0; i < n; i++) x->curve[i] += a->rate[i];
    x->curve[0] += w * x->psi[q];
    x->curve[q] -= w * x->psi[0];
}

/* The end of a step; 0 where it has no solution. */
static inline int step_fluxes(const machines_t *m, int64_t k, double h, const acting_t *a, const fluxes_t *x0,
                              fluxes_t *x1)
{
    const int64_t n = m->n_flux[k], q = m->q[k];
    const double half = 0.5 * h, twelfth = h * h / 12.0, w = m->stator[k] * a->speed_rate;
    double pushed[MOST_FLUX], column[MOST_FLUX], once[MOST_FLUX], twice[MOST_FLUX], matrix[MOST_FLUX * MOST_FLUX];
    flux_rates(m, k, a->speed, a->b, pushed);
    for (int64_t j = 0; j < n; j++) {
        for (int64_t i = 0; i < n; i++) column[i] = i == j ? 1.0 : 0.0;
        flux_rates(m, k, a->speed, column, once);
        flux_rates(m, k, a->speed, once, twice);
        twice[0] += w * column[q];
        twice[q] -= w * column[0];
        for (int64_t i = 0; i < n; i++) matrix[i * n + j] = column[i] - half * once[i] + twelfth * twice[i];
    }
    for (int64_t i = 0; i < n; i++)
        x1->psi[i] = x0->psi[i] + half * (x0->slope[i] + a->b[i])
                     + twelfth * (x0->curve[i] - pushed[i] - a->rate[i]);
    return (int)solve_real(n, 1, matrix, x1->psi);
}

/* Torque of a motor and its rate. */
static inline point_t air_gap(const machines_t *m, int64_t k, const fluxes_t *x)
{
    const int64_t n = m->n_flux[k], q = m->q[k];
    const double *row = m->current + 2 * k * m->most, *next = row + m->most;
    const double id = times_row(n, row, x->psi), iq = times_row(n, next, x->psi);
    const double rd = times_row(n, row, x->slope), rq = times_row(n, next, x->slope);
    return (point_t){m->base[k] * (x->psi[0] * iq - x->psi[q] * id),
                     m->base[k] * (x->slope[0] * iq + x->psi[0] * rq - x->slope[q] * id - x->psi[q] * rd)};
}
#endif
