/* Flux linkages of motors in time: one step beside that of the modes.
 *
 * dψ/dt = A ψ + ω W ψ + ω₀ u + e in the axes of the rotor, whose electrical speed ω and angle are those of its station.
 * A step has values and first three derivatives at both ends (Hermite and Obreshkov: sixth order, A-stable; at one
 * speed the Padé approximant of the exponential). Its error is far below that of the cubic which the modes take
 * torques as:
 *
 *     ψ₁ = ψ₀ + h/2 (ψ'₀ + ψ'₁) + h²/10 (ψ''₀ − ψ''₁) + h³/120 (ψ'''₀ + ψ'''₁)
 *
 * which is linear in ψ₁ where the motion of the rotor is known. The inverse of its matrix is kept for a speed nearby,
 * and the fluxes are corrected by it as often as the motion.
 *
 * Where the axes of the stator are connected unlike (rows of `machine_t`) u follows from the currents and their rates: two
 * equations G u = ρ, and the same with their rates, in axes that turn with the rotor.
 */
#ifndef TORSION_FLUXES_H
#define TORSION_FLUXES_H
#include "forces.h"

enum { MOST_FLUX = 8 };

/* The inverse holds up to this change of half the electrical angle that a step turns [rad]: a correction leaves
 * that share of what it corrects, as much as the motion leaves of a change of the torque. */
static const double NEARBY = 2.5e-4;

/* A quantity and its first two rates. */
typedef struct { double value, slope, curve; } jet_t;

/* The same with its third rate. */
typedef struct { double rate[4]; } long_jet_t;

/* How a rotor moves: its speed, and the speed at which the voltage is read [rad/s, rad/s², rad/s³]. */
typedef struct { jet_t speed, read; } rotor_t;

/* Two axes of a stator that are connected unlike: their directions in the rotor's axes, what G is, and the source's voltage
 * along each. Rates count from 0. */
typedef struct { double angle; long_jet_t along[2][2]; double g[3][2][2], source[3][2]; } axes_t;

/* What acts on the fluxes of a motor at one time: voltages, the electrical speed of its rotor, and their rates. Voltages of
 * axes that are connected unlike are none of them. */
typedef struct { double b[MOST_FLUX], rate[MOST_FLUX], curve[MOST_FLUX]; jet_t speed; axes_t axes; } acting_t;

/* Fluxes of a motor and their first three derivatives. */
typedef struct { double psi[MOST_FLUX], slope[MOST_FLUX], curve[MOST_FLUX], third[MOST_FLUX]; } fluxes_t;

/* Inverse of the matrix of a step, and the step, the electrical speed and the angle of the axes that it was made for. */
typedef struct { double h, speed, angle, inverse[MOST_FLUX * MOST_FLUX]; } inverse_t;

static inline double times_row(int64_t n, const double *row, const double *x)
{
    double sum = 0.0;
    for (int64_t i = 0; i < n; i++) sum += row[i] * x[i];
    return sum;
}

/* Voltage that the line leaves a motor at a speed. */
static inline jet_t line_voltage(const drive_t *d, int64_t k, jet_t read)
{
    const machines_t *m = &d->machines;
    const double own = d->motor_speed[m->motor[k]];
    const double dx = read.slope / own, ddx = read.curve / own;
    const double *c;
    held_t piece;
    double x = read.value / own, slope, bend;
    if (m->voltage[k] < 0) return (jet_t){1.0, 0.0, 0.0};
    hold(&d->curves, m->voltage[k], 0, x, &piece);
    c = piece.cubic;
    x -= piece.knot;
    slope = c[1] + x * (2.0 * c[2] + 3.0 * x * c[3]);
    bend = 2.0 * c[2] + 6.0 * x * c[3];
    return (jet_t){c[0] + x * (c[1] + x * (c[2] + x * c[3])), slope * dx, bend * dx * dx + slope * ddx};
}

/* Adds size × (cos, sin) of an angle to the jets of both axes. */
static inline void turning_voltage(double size, jet_t angle, jet_t *d, jet_t *q)
{
    const sincos_t wave = sin_cos(angle.value);
    const double c = size * wave.cosine, s = size * wave.sine, square = angle.slope * angle.slope;
    d->value += c;
    q->value += s;
    d->slope -= angle.slope * s;
    q->slope += angle.slope * c;
    d->curve -= angle.curve * s + square * c;
    q->curve += angle.curve * c - square * s;
}

/* What a voltage does that grows and falls with another. */
static inline jet_t both(jet_t a, jet_t b)
{
    return (jet_t){a.value * b.value, a.slope * b.value + a.value * b.slope,
                   a.curve * b.value + 2.0 * a.slope * b.slope + a.value * b.curve};
}

/* Voltage that a soft starter leaves of it; `inside` is a time within the step. */
static inline jet_t ramp_voltage(const double *ramp, double t, double inside)
{
    const double slope = (1.0 - ramp[0]) / ramp[1];
    if (!(inside < ramp[1])) return (jet_t){1.0, 0.0, 0.0};
    return (jet_t){ramp[0] + slope * t, slope, 0.0};
}

static const double BINOMIAL[4][4] = {{1.0, 0.0, 0.0, 0.0}, {1.0, 1.0, 0.0, 0.0}, {1.0, 2.0, 1.0, 0.0}, {1.0, 3.0, 3.0, 1.0}};

/* Directions of both axes at an angle of the first one whose rates are those of the rotor's speed, backwards. */
static inline void turning_axes(double angle, jet_t speed, axes_t *x)
{
    const sincos_t at = sin_cos(angle);
    const double c = at.cosine, s = at.sine, a = -speed.value, b = -speed.slope, d = -speed.curve;
    const long_jet_t cosine = {{c, -a * s, -b * s - a * a * c, -d * s - 3.0 * a * b * c + a * a * a * s}};
    const long_jet_t sine = {{s, a * c, b * c - a * a * s, d * c - 3.0 * a * b * s - a * a * a * c}};
    x->angle = angle;
    x->along[0][0] = x->along[1][1] = cosine;
    x->along[0][1] = x->along[1][0] = sine;
    for (int i = 0; i < 4; i++) x->along[1][0].rate[i] = -sine.rate[i];
}

/* G and what the source gives along both axes, with their rates; `e`: the voltage of the source in the rotor's axes. */
static inline void unlike_axes(const machines_t *m, int64_t k, double angle, jet_t speed, const jet_t *e, axes_t *x)
{
    const int64_t stator[2] = {0, m->q[k]};
    const double *rows = m->rows + 8 * k;
    const double of[3][2] = {{e[0].value, e[1].value}, {e[0].slope, e[1].slope}, {e[0].curve, e[1].curve}};
    turning_axes(angle, speed, x);
    for (int r = 0; r < 3; r++)
        for (int i = 0; i < 2; i++) {
            x->source[r][i] = 0.0;
            for (int j = 0; j < 2; j++) x->g[r][i][j] = r == 0 && i == j ? rows[4 * i] : 0.0;
            for (int p = 0; p <= r; p++) {
                const double share = BINOMIAL[r][p];
                for (int d = 0; d < 2; d++) {
                    const double to = x->along[i][d].rate[p];
                    x->source[r][i] += share * to * of[r - p][d];
                    for (int j = 0; j < 2; j++)
                        for (int c = 0; c < 2; c++)
                            x->g[r][i][j] += share * rows[4 * i + 1] * m->line_omega * to
                                             * m->current[(2 * k + d) * m->most + stator[c]] * x->along[j][c].rate[r - p];
                }
            }
            x->source[r][i] *= rows[4 * i + 2];
        }
}

/* `phase` is twice the angle of the line ahead of the rotor. */
static inline void acting(const drive_t *d, int64_t k, double t, double inside, double phase, const rotor_t *rotor,
                          acting_t *a)
{
    const machines_t *m = &d->machines;
    const int64_t n = m->n_flux[k], q = m->q[k], motor = m->motor[k];
    const double pairs = d->pole_pairs[motor], line = m->line_omega, share = m->stator[k] * line;
    const double *forward = m->forward + 2 * k, *backward = m->backward + 2 * k;
    const jet_t v = both(line_voltage(d, k, rotor->read), ramp_voltage(m->ramp + 2 * k, t, inside));
    jet_t on_d = {0.0, 0.0, 0.0}, on_q = {0.0, 0.0, 0.0}, grown = {1.0, 0.0, 0.0};
    a->speed = (jet_t){m->frame + pairs * rotor->speed.value, pairs * rotor->speed.slope, pairs * rotor->speed.curve};
    turning_voltage(forward[0], (jet_t){0.5 * phase + forward[1], line - a->speed.value, -a->speed.slope}, &on_d, &on_q);
    if (backward[0] != 0.0)
        turning_voltage(backward[0],
                        (jet_t){0.5 * phase + backward[1] - 2.0 * line * t, -line - a->speed.value, -a->speed.slope},
                        &on_d, &on_q);
    if (inside >= d->field_time[motor] && !isinf(d->field_rate[motor])) {
        const double since = t - d->field_time[motor], rate = d->field_rate[motor];
        const double left = exponential(-rate * (since > 0.0 ? since : 0.0));
        grown = (jet_t){1.0 - left, rate * left, -rate * rate * left};
    }
    for (int64_t i = 0; i < n; i++) {
        const double field = m->field[k * m->most + i];
        a->b[i] = field * grown.value;
        a->rate[i] = field * grown.slope;
        a->curve[i] = field * grown.curve;
    }
    on_d = both(v, on_d);
    on_q = both(v, on_q);
    a->axes.angle = 0.0;
    if (m->unlike[k]) {
        const jet_t source[2] = {on_d, on_q};
        unlike_axes(m, k, 0.5 * phase + m->axis[k] - line * t, a->speed, source, &a->axes);
        return;
    }
    a->b[0] += share * on_d.value;
    a->b[q] += share * on_q.value;
    a->rate[0] += share * on_d.slope;
    a->rate[q] += share * on_q.slope;
    a->curve[0] += share * on_d.curve;
    a->curve[q] += share * on_q.curve;
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

/* Adds the voltages of axes that are connected unlike to the r-th rate of the fluxes, which has all else; those before it
 * are whole. `u`, along both axes, and `bare`, rates of the currents d and q without them, are kept from rate to rate. */
static inline void add_unlike(const machines_t *m, int64_t k, const axes_t *x, int r, const double *const *rates,
                              double (*u)[2], double (*bare)[2], double *flux)
{
    const int64_t n = m->n_flux[k], stator[2] = {0, m->q[k]};
    const double *rows = m->rows + 8 * k, *current = m->current + 2 * k * m->most;
    const double (*g)[2] = x->g[0], whole = g[0][0] * g[1][1] - g[0][1] * g[1][0];
    double left[2], i[3][2];
    for (int d = 0; d < 2; d++) bare[r][d] = times_row(n, current + d * m->most, flux);
    for (int p = 0; p <= r; p++)
        for (int d = 0; d < 2; d++) i[p][d] = times_row(n, current + d * m->most, rates[p]);
    for (int a = 0; a < 2; a++) {
        left[a] = x->source[r][a];
        for (int p = 0; p <= r; p++)
            for (int d = 0; d < 2; d++) {
                const double *to = x->along[a][d].rate, share = BINOMIAL[r][p];
                left[a] -= share * (rows[4 * a + 3] * to[p] * i[r - p][d]
                                    + rows[4 * a + 1] * (to[p] * bare[r - p][d] + to[p + 1] * i[r - p][d]));
                if (p > 0) left[a] -= share * x->g[p][a][d] * u[r - p][d];
            }
    }
    u[r][0] = (left[0] * g[1][1] - g[0][1] * left[1]) / whole;
    u[r][1] = (g[0][0] * left[1] - left[0] * g[1][0]) / whole;
    for (int d = 0; d < 2; d++)
        for (int p = 0; p <= r; p++)
            for (int a = 0; a < 2; a++)
                flux[stator[d]] += m->line_omega * BINOMIAL[r][p] * u[p][a] * x->along[a][d].rate[r - p];
}

static inline void derivatives(const machines_t *m, int64_t k, const acting_t *a, fluxes_t *x)
{
    const int64_t n = m->n_flux[k], q = m->q[k];
    const double w = m->stator[k] * a->speed.slope, z = m->stator[k] * a->speed.curve;
    const double *const rates[3] = {x->psi, x->slope, x->curve};
    double u[3][2], bare[3][2];
    flux_rates(m, k, a->speed.value, x->psi, x->slope);
    for (int64_t i = 0; i < n; i++) x->slope[i] += a->b[i];
    if (m->unlike[k]) add_unlike(m, k, &a->axes, 0, rates, u, bare, x->slope);
    flux_rates(m, k, a->speed.value, x->slope, x->curve);
    for (int64_t i = 0; i < n; i++) x->curve[i] += a->rate[i];
    x->curve[0] += w * x->psi[q];
    x->curve[q] -= w * x->psi[0];
    if (m->unlike[k]) add_unlike(m, k, &a->axes, 1, rates, u, bare, x->curve);
    flux_rates(m, k, a->speed.value, x->curve, x->third);
    for (int64_t i = 0; i < n; i++) x->third[i] += a->curve[i];
    x->third[0] += 2.0 * w * x->slope[q] + z * x->psi[q];
    x->third[q] -= 2.0 * w * x->slope[0] + z * x->psi[0];
    if (m->unlike[k]) add_unlike(m, k, &a->axes, 2, rates, u, bare, x->third);
}

/* Fluxes that go on as their derivatives say, and their rates. */
static inline void fluxes_go_on(int64_t n, double h, const fluxes_t *x0, fluxes_t *x1)
{
    for (int64_t i = 0; i < n; i++) {
        x1->psi[i] = x0->psi[i] + h * (x0->slope[i] + 0.5 * h * (x0->curve[i] + h / 3.0 * x0->third[i]));
        x1->slope[i] = x0->slope[i] + h * (x0->curve[i] + 0.5 * h * x0->third[i]);
    }
}

/* What a step makes of a change of the fluxes at its end, at one speed, or under axes that are connected unlike. */
static inline void rates_of_change(const machines_t *m, int64_t k, const acting_t *a, fluxes_t *x)
{
    if (m->unlike[k]) {
        derivatives(m, k, a, x);
        return;
    }
    flux_rates(m, k, a->speed.value, x->psi, x->slope);
    flux_rates(m, k, a->speed.value, x->slope, x->curve);
    flux_rates(m, k, a->speed.value, x->curve, x->third);
}

/* The inverse for a step under what acts; 0 where there is none. */
static inline int make_inverse(const machines_t *m, int64_t k, double h, const acting_t *a, inverse_t *inverse)
{
    const int64_t n = m->n_flux[k];
    double matrix[MOST_FLUX * MOST_FLUX];
    acting_t alone = *a; /* without voltages */
    fluxes_t x;
    for (int64_t i = 0; i < n; i++) alone.b[i] = alone.rate[i] = alone.curve[i] = 0.0;
    for (int i = 0; i < 6; i++) alone.axes.source[i / 2][i % 2] = 0.0;
    for (int64_t j = 0; j < n; j++) {
        for (int64_t i = 0; i < n; i++) x.psi[i] = i == j ? 1.0 : 0.0;
        rates_of_change(m, k, &alone, &x);
        for (int64_t i = 0; i < n; i++) {
            matrix[i * n + j] = x.psi[i] - 0.5 * h * x.slope[i] + h * h / 10.0 * x.curve[i] - h * h * h / 120.0 * x.third[i];
            inverse->inverse[i * n + j] = i == j ? 1.0 : 0.0;
        }
    }
    inverse->h = h;
    inverse->speed = a->speed.value;
    inverse->angle = a->axes.angle;
    return (int)solve_real(n, n, matrix, inverse->inverse);
}

/* Corrects the end of a step; 0 where it has no solution. */
static inline int step_fluxes(const machines_t *m, int64_t k, double h, const acting_t *a, const fluxes_t *x0,
                              fluxes_t *x1, inverse_t *inverse)
{
    const int64_t n = m->n_flux[k];
    const double half = 0.5 * h, tenth = h * h / 10.0, least = h * h * h / 120.0;
    double left[MOST_FLUX];
    if (!(inverse->h == h && half * fabs(a->speed.value - inverse->speed) <= NEARBY
          && fabs(a->axes.angle - inverse->angle) <= NEARBY)
        && !make_inverse(m, k, h, a, inverse))
        return 0;
    derivatives(m, k, a, x1);
    for (int64_t i = 0; i < n; i++)
        left[i] = x0->psi[i] - x1->psi[i] + half * (x0->slope[i] + x1->slope[i]) + tenth * (x0->curve[i] - x1->curve[i])
                  + least * (x0->third[i] + x1->third[i]);
    for (int64_t i = 0; i < n; i++) x1->psi[i] += times_row(n, inverse->inverse + i * n, left);
    derivatives(m, k, a, x1);
    return 1;
}

/* A current below zero by so much counts as one that has changed its sign, so that it stays changed [pu]. */
static const double TURNS_BACK = 1e-9;

/* What has to stay positive for the resistance of the field to stay, and its rate. */
static inline point_t field_left(const machines_t *m, int64_t k, const fluxes_t *x)
{
    const double *row = m->watch + k * m->most;
    const int64_t n = m->n_flux[k];
    if (m->watched[k] == 1) return (point_t){TURNS_BACK + times_row(n, row, x->psi), times_row(n, row, x->slope)};
    return (point_t){TURNS_BACK + times_row(n, row, x->slope), times_row(n, row, x->curve)};
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
