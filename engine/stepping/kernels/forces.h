/* Torques of motors and loads, and prescribed ones. */
#ifndef TORSION_FORCES_H
#define TORSION_FORCES_H
#include "elementary.h"
#include "kernels.h"
#include "segment.h"

typedef struct { double value, slope; } point_t;

/* The piece of a curve on which each lane stands: it holds from `low` to below `high`. */
typedef struct { lane_t low, high, knot, cubic[4]; } held_t;

enum { HELD = sizeof(held_t) / sizeof(double), CURVES_OF_MOTOR = 2 };

static const double TURN = 12.566370614359172; /* 4π: half a phase is a load angle */

/* Doubles that the pieces of all curves take. */
static inline int64_t held_room(const drive_t *d) { return HELD * (CURVES_OF_MOTOR * d->n_motors + d->n_loads); }

/* No lane stands on any piece yet. */
static inline void hold_none(const drive_t *d, held_t *held)
{
    for (int64_t k = 0; k < CURVES_OF_MOTOR * d->n_motors + d->n_loads; k++)
        held[k] = (held_t){all(HUGE_VAL), all(-HUGE_VAL), all(0.0), {all(0.0), all(0.0), all(0.0), all(0.0)}};
}

/* A lane steps on the piece of a curve that holds x; outside its knots a curve is constant. */
static inline void hold(const curves_t *curves, int64_t which, int64_t lane, double x, held_t *held)
{
    const int64_t curve = lane * curves->n + which, last = curves->counts[curve] - 1;
    const double *knots = curves->knots + curve * curves->longest;
    const double *cubics = curves->cubics + 4 * curve * curves->longest;
    const double inside = nextafter(knots[0], HUGE_VAL); /* at the first knot the slope is still zero */
    int64_t low = x < inside ? 0 : x >= knots[last] ? last : segment(knots, last + 1, x);
    int varies = x >= inside && x < knots[last];
    AT(held->low, lane) = x < inside ? -HUGE_VAL : low == 0 ? inside : knots[low];
    AT(held->high, lane) = x < inside ? inside : varies ? knots[low + 1] : HUGE_VAL;
    AT(held->knot, lane) = knots[low];
    AT(held->cubic[0], lane) = cubics[4 * low];
    for (int j = 1; j < 4; j++) AT(held->cubic[j], lane) = varies ? cubics[4 * low + j] : 0.0;
}

/* Value and slope of a curve. */
static inline lane_t on_curve(const curves_t *curves, int64_t which, lane_t x, held_t *held, lane_t *slope)
{
    const mask_t left = (x < held->low) | (x >= held->high);
    const lane_t *c = held->cubic;
    lane_t s;
    for (int l = 0; any(left) && l < LANES; l++)
        if (AT(left, l)) hold(curves, which, l, AT(x, l), held);
    s = x - held->knot;
    *slope = c[1] + s * (2.0 * c[2] + 3.0 * s * c[3]);
    return c[0] + s * (c[1] + s * (c[2] + s * c[3]));
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

static inline lane_t in_turns(lane_t phase)
{
    const mask_t out = (phase >= TURN) | (phase < 0.0);
    for (int l = 0; any(out) && l < LANES; l++) AT(phase, l) = in_turn(AT(phase, l));
    return phase;
}

/* What is electrical besides the curves: transient at breaker closing, field. */
static inline point_t electrical(const drive_t *d, int64_t m, int l, double t, double inside, double phase,
                                 double phase_rate)
{
    const int64_t k = m * LANES + l;
    point_t torque = {0.0, 0.0};
    if (d->shock[k] != 0.0) { /* e^(−rate t) sin ωt */
        double size = d->shock[k] * exponential(-d->shock_rate[k] * t), omega = d->shock_omega[l];
        sincos_t wave = sin_cos(omega * t);
        torque.value += size * wave.sine;
        torque.slope += size * (omega * wave.cosine - d->shock_rate[k] * wave.sine);
    }
    if (inside >= d->field_time[k]) { /* (1 − e^(−rate t)) sin δ */
        double grown = 1.0, growth = 0.0, since = t - d->field_time[k];
        sincos_t wave = sin_cos(0.5 * phase + d->polarity[k]);
        if (!isinf(d->field_rate[k])) {
            double left = exponential(-d->field_rate[k] * (since > 0.0 ? since : 0.0));
            grown = 1.0 - left;
            growth = d->field_rate[k] * left;
        }
        torque.value += d->pull_out[k] * grown * wave.sine;
        torque.slope += d->pull_out[k] * (growth * wave.sine + grown * wave.cosine * 0.5 * phase_rate);
    }
    return torque;
}

/* With the field on the cage has another torque: a curve of its own, or one in proportion to slip. */
static inline point_t with_field(const drive_t *d, int64_t m, int l, double x, double speed)
{
    const int64_t k = m * LANES + l;
    held_t piece;
    point_t torque;
    if (d->cage[k] == d->cage[k])
        return (point_t){d->cage[k] * (d->motor_speed[k] - speed), -d->cage[k] * d->motor_speed[k]};
    hold(&d->curves, d->with_field[m], l, x, &piece);
    x -= AT(piece.knot, l);
    torque.value = AT(piece.cubic[0], l)
                   + x * (AT(piece.cubic[1], l) + x * (AT(piece.cubic[2], l) + x * AT(piece.cubic[3], l)));
    torque.slope = AT(piece.cubic[1], l) + x * (2.0 * AT(piece.cubic[2], l) + 3.0 * x * AT(piece.cubic[3], l));
    return torque;
}

/* Curves are read at a speed of their own, `read`; the phase of the pulsation follows that of the station. */
static inline void motor_forces(const drive_t *d, lane_t t, lane_t inside, const lane_t *phase, const lane_t *speed,
                                const lane_t *read, const lane_t *read_rate, held_t *held, lane_t *force,
                                lane_t *force_rate)
{
    for (int64_t m = 0; m < d->n_motors; m++, held += CURVES_OF_MOTOR) {
        const int64_t f = d->motor_force[m];
        const lane_t own = lanes_of(d->motor_speed)[m];
        const lane_t x = read[m] / own, dx = read_rate[m] / own;
        const lane_t phase_rate = 2.0 * (lanes_of(d->line_omega)[m] - lanes_of(d->pole_pairs)[m] * speed[f]);
        const mask_t on = inside >= lanes_of(d->field_time)[m];
        lane_t average, steepness, pulsating, growth, more = all(0.0), more_rate = all(0.0);
        waves_t wave;
        if (d->connected[m * LANES] == 0.0) continue; /* in all lanes */
        average = on_curve(&d->curves, d->average[m], x, held, &steepness);
        pulsating = on_curve(&d->curves, d->pulsating[m], x, held + 1, &growth);
        wave = waves_of(phase[m]);
        for (int l = 0; l < LANES && any(on | (lanes_of(d->shock)[m] != 0.0)); l++) {
            point_t torque = electrical(d, m, l, AT(t, l), AT(inside, l), AT(phase[m], l), AT(phase_rate, l));
            AT(more, l) = torque.value;
            AT(more_rate, l) = torque.slope;
            if (!AT(on, l)) continue;
            torque = with_field(d, m, l, AT(x, l), AT(read[m], l));
            AT(average, l) = torque.value;
            AT(steepness, l) = torque.slope;
        }
        force[f] += average + pulsating * wave.sine + more;
        force_rate[f] += (steepness + growth * wave.sine) * dx
                         + pulsating * wave.cosine * phase_rate + more_rate;
    }
}

/* Loads oppose motion; near standstill they pass smoothly through zero. */
static inline void load_forces(const drive_t *d, const lane_t *speed, const lane_t *acceleration, held_t *held,
                               lane_t *force, lane_t *force_rate)
{
    for (int64_t k = 0; k < d->n_loads; k++) {
        const int64_t f = d->load_force[k];
        const lane_t own = lanes_of(d->load_speed)[k], soft = lanes_of(d->soft_speed)[k];
        const lane_t x = speed[f] / own, z = speed[f] / soft;
        const mask_t slow = z < 1.0;
        lane_t sign = all(1.0), turn = all(0.0), side = all(1.0), torque, slope;
        for (int l = 0; any(slow) && l < LANES; l++) {
            double at = AT(z, l);
            if (!AT(slow, l)) continue;
            at = at > -1.0 ? at : -1.0;
            AT(sign, l) = at * (1.5 - 0.5 * at * at);
            AT(turn, l) = AT(z, l) > -1.0 ? 1.5 * (1.0 - at * at) / AT(soft, l) : 0.0;
            AT(side, l) = AT(x, l) >= 0.0 ? 1.0 : -1.0;
        }
        torque = on_curve(&d->curves, d->load_curve[k], magnitude(x), held + k, &slope);
        force[f] -= torque * sign;
        force_rate[f] -= (slope * side / own * sign + torque * turn) * acceleration[f];
    }
}

/* Tables against time, read on the segment that holds `inside`: a jump at the end of a step is not seen
 * before it happens. */
static inline void timed_forces(const drive_t *d, lane_t t, lane_t inside, lane_t *force, lane_t *force_rate)
{
    for (int64_t k = 0; k < d->n_timed; k++)
        for (int l = 0; l < LANES; l++) {
            const int64_t table = l * d->n_timed + k, last = d->timed_count[table] - 1, f = d->timed_force[k];
            const double *times = d->times + table * d->most_timed, *torques = d->torques + table * d->most_timed;
            const double at = AT(inside, l);
            if (at >= times[last]) {
                AT(force[f], l) += torques[last];
            } else if (at >= times[0]) {
                int64_t low = segment(times, last + 1, at);
                double slope = (torques[low + 1] - torques[low]) / (times[low + 1] - times[low]);
                AT(force[f], l) += torques[low] + slope * (AT(t, l) - times[low]);
                AT(force_rate[f], l) += slope;
            }
        }
}

/* Decaying harmonic torques of an event in operation. */
static inline void tone_forces(const drive_t *d, lane_t t, lane_t *force, lane_t *force_rate)
{
    for (int64_t k = 0; k < d->n_tones; k++) {
        const double omega = d->tone_omega[k], decay = d->tone_decay[k], at = AT(t, 0);
        const double size = d->tone_size[k] * exponential(-decay * at);
        const sincos_t wave = sin_cos(omega * at + d->tone_phase[k]);
        AT(force[d->tone_force[k]], 0) += size * wave.cosine;
        AT(force_rate[d->tone_force[k]], 0) -= size * (omega * wave.sine + decay * wave.cosine);
    }
}

/* Every force but those of dampers, and its rate. */
static inline void machine_forces(const drive_t *d, int64_t n_forces, lane_t t, lane_t inside, const lane_t *phase,
                                  const lane_t *speed, const lane_t *acceleration, const lane_t *read,
                                  const lane_t *read_rate, held_t *held, lane_t *force, lane_t *force_rate)
{
    for (int64_t f = 0; f < n_forces; f++) force[f] = force_rate[f] = all(0.0);
    motor_forces(d, t, inside, phase, speed, read, read_rate, held, force, force_rate);
    load_forces(d, speed, acceleration, held + CURVES_OF_MOTOR * d->n_motors, force, force_rate);
    timed_forces(d, t, inside, force, force_rate);
    tone_forces(d, t, force, force_rate);
}

static inline void damper_forces(int64_t n, const int64_t *on, const double *viscous, const lane_t *speed,
                                 const lane_t *acceleration, lane_t *force, lane_t *force_rate)
{
    for (int64_t k = 0; k < n; k++) {
        force[on[k]] -= lanes_of(viscous)[k] * speed[on[k]];
        force_rate[on[k]] -= lanes_of(viscous)[k] * acceleration[on[k]];
    }
}
#endif
