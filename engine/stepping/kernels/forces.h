/* Torques of motors and loads, and prescribed ones. */
#ifndef TORSION_FORCES_H
#define TORSION_FORCES_H
#include "elementary.h"
#include "kernels.h"

typedef struct { double value, slope; } point_t;

static const double TURN = 12.566370614359172; /* 4π: half a phase is a load angle */

/* Segment of a table that holds x, which lies within it. */
static inline int64_t segment(const double *knots, int64_t count, double x)
{
    int64_t low = 0, high = count - 1;
    while (high - low > 1) {
        int64_t middle = (low + high) / 2;
        if (knots[middle] <= x) low = middle;
        else high = middle;
    }
    return low;
}

/* Value and slope of a curve, held constant outside its knots. */
static inline point_t on_curve(const curves_t *curves, int64_t which, double x)
{
    const double *knots = curves->knots + which * curves->longest;
    const double *cubics = curves->cubics + 4 * which * curves->longest;
    int64_t last = curves->counts[which] - 1, low;
    const double *c;
    double s;
    if (x <= knots[0]) return (point_t){cubics[0], 0.0};
    if (x >= knots[last]) return (point_t){cubics[4 * last], 0.0};
    low = segment(knots, last + 1, x);
    s = x - knots[low];
    c = cubics + 4 * low;
    return (point_t){c[0] + s * (c[1] + s * (c[2] + s * c[3])), c[1] + s * (2.0 * c[2] + 3.0 * s * c[3])};
}

/* Modulo 4π, as a fraction of a turn from zero up. */
static inline double in_turn(double phase)
{
    if (phase >= TURN || phase < 0.0) {
        phase = fmod(phase, TURN);
        if (phase < 0.0) phase += TURN;
    }
    return phase;
}

/* What is electrical besides the curves: transient at breaker closing, field. */
static inline point_t electrical(const drive_t *d, int64_t m, double t, double inside, double phase,
                                 double phase_rate)
{
    point_t torque = {0.0, 0.0};
    if (d->shock[m] != 0.0) { /* e^(−rate t) sin ωt */
        double size = d->shock[m] * exponential(-d->shock_rate[m] * t);
        sincos_t wave = sin_cos(d->shock_omega * t);
        torque.value += size * wave.sine;
        torque.slope += size * (d->shock_omega * wave.cosine - d->shock_rate[m] * wave.sine);
    }
    if (inside >= d->field_time[m]) { /* (1 − e^(−rate t)) sin δ */
        double grown = 1.0, growth = 0.0, since = t - d->field_time[m];
        sincos_t wave = sin_cos(0.5 * phase + d->polarity[m]);
        if (!isinf(d->field_rate[m])) {
            double left = exponential(-d->field_rate[m] * (since > 0.0 ? since : 0.0));
            grown = 1.0 - left;
            growth = d->field_rate[m] * left;
        }
        torque.value += d->pull_out[m] * grown * wave.sine;
        torque.slope += d->pull_out[m] * (growth * wave.sine + grown * wave.cosine * 0.5 * phase_rate);
    }
    return torque;
}

static inline void motor_forces(const drive_t *d, double t, double inside, const double *phase,
                                const double *speed, const double *acceleration, double *force,
                                double *force_rate)
{
    for (int64_t m = 0; m < d->n_motors; m++) {
        int64_t f = d->motor_force[m];
        double x = speed[f] / d->motor_speed[m], dx = acceleration[f] / d->motor_speed[m];
        double phase_rate = 2.0 * (d->line_omega - d->pole_pairs[m] * speed[f]);
        int on = inside >= d->field_time[m];
        point_t more;
        point_t average, pulsating;
        sincos_t wave;
        if (d->connected[m] == 0.0) continue;
        average = on_curve(&d->curves, on ? d->with_field[m] : d->average[m], x);
        pulsating = on_curve(&d->curves, d->pulsating[m], x);
        wave = sin_cos(phase[m]);
        more = electrical(d, m, t, inside, phase[m], phase_rate);
        if (on && d->cage[m] == d->cage[m]) { /* a torque in proportion to slip, not the curve */
            average.value = d->cage[m] * (d->motor_speed[m] - speed[f]);
            average.slope = -d->cage[m] * d->motor_speed[m];
        }
        force[f] += average.value + pulsating.value * wave.sine + more.value;
        force_rate[f] += (average.slope + pulsating.slope * wave.sine) * dx
                         + pulsating.value * wave.cosine * phase_rate + more.slope;
    }
}

/* Loads oppose motion; near standstill they pass smoothly through zero. */
static inline void load_forces(const drive_t *d, const double *speed, const double *acceleration,
                               double *force, double *force_rate)
{
    for (int64_t k = 0; k < d->n_loads; k++) {
        int64_t f = d->load_force[k];
        double x = speed[f] / d->load_speed[k], z = speed[f] / d->soft_speed[k];
        point_t torque = on_curve(&d->curves, d->load_curve[k], fabs(x));
        double sign = 1.0, turn = 0.0;
        if (z < 1.0) {
            double soft = z > -1.0 ? 1.0 : 0.0;
            z = z > -1.0 ? z : -1.0;
            sign = z * (1.5 - 0.5 * z * z);
            turn = 1.5 * (1.0 - z * z) / d->soft_speed[k] * soft;
        }
        force[f] -= torque.value * sign;
        force_rate[f] -= (torque.slope * (x >= 0.0 ? 1.0 : -1.0) / d->load_speed[k] * sign
                          + torque.value * turn) * acceleration[f];
    }
}

/* Tables against time, read on the segment that holds `inside`: a jump at the end of a step is not seen
 * before it happens. */
static inline void timed_forces(const drive_t *d, double t, double inside, double *force,
                                double *force_rate)
{
    for (int64_t k = 0; k < d->n_timed; k++) {
        const double *times = d->times + k * d->most_timed, *torques = d->torques + k * d->most_timed;
        int64_t last = d->timed_count[k] - 1, f = d->timed_force[k];
        if (inside >= times[last]) {
            force[f] += torques[last];
        } else if (inside >= times[0]) {
            int64_t low = segment(times, last + 1, inside);
            double slope = (torques[low + 1] - torques[low]) / (times[low + 1] - times[low]);
            force[f] += torques[low] + slope * (t - times[low]);
            force_rate[f] += slope;
        }
    }
}

/* Every force but those of dampers, and its rate. */
static inline void machine_forces(const drive_t *d, int64_t n_forces, double t, double inside,
                                  const double *phase, const double *speed, const double *acceleration,
                                  double *force, double *force_rate)
{
    for (int64_t f = 0; f < n_forces; f++) force[f] = force_rate[f] = 0.0;
    motor_forces(d, t, inside, phase, speed, acceleration, force, force_rate);
    load_forces(d, speed, acceleration, force, force_rate);
    timed_forces(d, t, inside, force, force_rate);
}

static inline void damper_forces(int64_t n, const int64_t *on, const double *viscous, const double *speed,
                                 const double *acceleration, double *force, double *force_rate)
{
    for (int64_t k = 0; k < n; k++) {
        force[on[k]] -= viscous[k] * speed[on[k]];
        force_rate[on[k]] -= viscous[k] * acceleration[on[k]];
    }
}
#endif
