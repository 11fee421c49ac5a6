/* Starts without events; turning points. */
#include "forces.h"
#include "step.h"
#include "turning.h"
#include "vector_units.h"

/* Numbers of each mode, force, output and motor that a loop keeps: of its work, and of its copies (`laid_out`). */
enum { OF_MODES = 12 + 7 + 4, OF_FORCES = 4, OF_OUTPUTS = 5, OF_MOTORS = 2 };

static int64_t padded(int64_t n) { return (n + MANY - 1) / MANY * MANY; }

int64_t linear_room(int64_t lanes, const system_t *system, const drive_t *drive, const torques_t *torques)
{
    const int64_t modes = padded(system->n), forces = padded(system->n_forces), outputs = padded(torques->n);
    const int64_t motors = padded(drive->n_motors);
    return lanes * ((OF_MODES + 2 * forces + 2 * outputs + motors) * modes + OF_FORCES * forces
                    + (OF_OUTPUTS + forces) * outputs + OF_MOTORS * motors + drive->n_motors + held_room(drive));
}

int64_t lanes_at_once(void) { return MANY; }

void begin_starts(int64_t lanes, const system_t *system, const drive_t *drive, const torques_t *torques,
                  state_t *state, samples_t *out, double *room)
{
    widest(lanes)->begin(system, drive, torques, state, out, room);
}

void advance_starts(int64_t lanes, stretches_t *plan, const system_t *system, const drive_t *drive,
                    const torques_t *torques, state_t *state, samples_t *out, double *room)
{
    widest(lanes)->advance(plan, system, drive, torques, state, out, room);
}

void polynomial_step(int64_t n, const double *stiffness, const double *rate, double h, double *free,
                     double *forced)
{
    for (int64_t i = 0; i < n; i++) {
        map_t map = polynomial_map(stiffness[i], rate[i], h);
        put_map(&map, 1, 0, 1, 0, free + 4 * i, forced + 8 * i);
    }
}

void exponential_step(int64_t n, const double *stiffness, const double *rate, double h, double *free,
                      double *forced)
{
    for (int64_t i = 0; i < n; i++) {
        map_t map = exponential_map(stiffness[i], rate[i], h);
        put_map(&map, 1, 0, 1, 0, free + 4 * i, forced + 8 * i);
    }
}

void newmark_step(int64_t n, const double *stiffness, const double *rate, double h, double *free,
                  double *forced)
{
    for (int64_t i = 0; i < n; i++) {
        map_t map = newmark_map(stiffness[i], rate[i], h);
        put_map(&map, 1, 0, 1, 0, free + 4 * i, forced + 8 * i);
    }
}

void start_forces(double t, double inside, const double *phase, const double *speed,
                  const double *acceleration, const double *read, const double *read_rate, const drive_t *drive,
                  const system_t *system, double *room, double *force, double *force_rate)
{
    hold_none(drive, (held_t *)room);
    machine_forces(drive, system->n_forces, t, inside, phase, speed, acceleration, read, read_rate, (held_t *)room,
                   force, force_rate);
    damper_forces(system->n_dampers, system->damper_force, system->viscous, speed, acceleration, force,
                  force_rate);
}

/* Turning points of a piecewise cubic through values and slopes; at most 2 n. Returns how many.
 *
 * One within rounding of a sample may come twice, but is never missed. Two samples at one time are a corner or
 * a jump: both values count where the curve turns or jumps there. */
int64_t turning_points(int64_t n, const double *t, const double *y, const double *slope, double *when,
                       double *value)
{
    int64_t n_turns = 0;
    double size = 0.0;
    for (int64_t i = 0; i < n; i++) size = fabs(y[i]) > size ? fabs(y[i]) : size;
    for (int64_t i = 0; i + 1 < n; i++) {
        double h = t[i + 1] - t[i], rise = y[i + 1] - y[i];
        turning_t turning;
        if (h <= 0.0) { /* in free flight the slope is zero on one side: entry and exit count */
            if (fabs(rise) > 1e-9 * size || slope[i] * slope[i + 1] <= 0.0)
                for (int64_t j = i; j < i + 2; j++) {
                    when[n_turns] = t[j];
                    value[n_turns++] = y[j];
                }
            continue;
        }
        if (!any(may_turn(h, rise, slope[i], slope[i + 1]))) continue;
        turning = turning_of_step(t[i], h, y[i], rise, slope[i], slope[i + 1]);
        for (int j = 0; j < 2; j++)
            if (turning.is[j]) {
                when[n_turns] = turning.when[j];
                value[n_turns++] = turning.value[j];
            }
    }
    return n_turns;
}

/* Values closer than this share of the largest, at times closer than that of the end, are one. */
static const double SAME_VALUE = 1e-9, SAME_TIME = 1e-12;

/* Turning points from rest to the end, with the values there. One that lies on a sample, or at an event, comes twice
 * and counts once. `last`: times, torques and rates of the last two samples. Returns how many, n + 2 at most. */
int64_t turning_to_end(int64_t n, const double *when, const double *value, double size, double first, double end,
                       const double *last, double *to_when, double *to_value)
{
    const double h = last[1] - last[0], s = h > 0.0 ? (end - last[0]) / h : 1.0;
    const double y = last[2], rise = last[3] - y, a = h * last[4], b = h * last[5];
    int64_t k = 0;
    for (int64_t i = 0; i < n; i++) size = fabs(value[i]) > size ? fabs(value[i]) : size;
    to_when[k] = 0.0;
    to_value[k++] = first;
    for (int64_t i = 0; i < n; i++) {
        if (i > 0 && when[i] - when[i - 1] <= SAME_TIME * end && fabs(value[i] - value[i - 1]) <= SAME_VALUE * size)
            continue;
        if (!(when[i] < end)) continue;
        to_when[k] = when[i];
        to_value[k++] = value[i];
    }
    to_when[k] = end;
    to_value[k++] = y + s * (a + s * (3.0 * rise - 2.0 * a - b + s * (a + b - 2.0 * rise)));
    return k;
}

/* The same of each torque of a run from its samples, torque and rate (n_outputs, n), one after the other in to_when and
 * to_value; room: 4 n. */
void samples_to_end(int64_t n_outputs, int64_t n, const double *t, const double *torque, const double *rate, double end,
                    double *room, double *to_when, double *to_value, int64_t *to_count)
{
    double *when = room, *value = room + 2 * n;
    int64_t at = 0, next;
    while (at + 2 < n && t[at + 1] < end) at++;
    next = at + 1 < n ? at + 1 : at;
    for (int64_t i = 0; i < n_outputs; i++, torque += n, rate += n) {
        const double last[] = {t[at], t[next], torque[at], torque[next], rate[at], rate[next]};
        const int64_t turns = turning_points(n, t, torque, rate, when, value);
        double size = 0.0;
        for (int64_t j = 0; j < n; j++) size = fabs(torque[j]) > size ? fabs(torque[j]) : size;
        to_count[i] = turning_to_end(turns, when, value, size, torque[0], end, last, to_when, to_value);
        to_when += to_count[i];
        to_value += to_count[i];
    }
}

/* The same of each torque of one lane, from what the loop left; time: those of its last two rows; to_when and to_value:
 * (n, longest). */
void lane_to_end(int64_t n, int64_t lanes, int64_t lane, const samples_t *out, const double *first, const double *time,
                 double end, int64_t longest, double *to_when, double *to_value, int64_t *to_count)
{
    for (int64_t i = 0; i < n; i++) {
        const int64_t k = i * lanes + lane;
        const double last[] = {time[0], time[1], out->before[k], out->last[k], out->before_rate[k], out->last_rate[k]};
        to_count[i] = turning_to_end(out->count[k], out->when + k * out->room, out->value + k * out->room,
                                     out->largest[k], first[k], end, last, to_when + i * longest, to_value + i * longest);
    }
}

/* Of the extremes of two runs so many are compared, each with so many of the other run. */
enum { COMPARED = 6, NEAR = 2 * COMPARED };

/* Turning points of one torque; sign: −1 where minima are the largest. */
typedef struct { int64_t n; const double *when, *value; double sign; } extremes_t;

static double time_of_largest(extremes_t x)
{
    int64_t top = 0;
    for (int64_t i = 1; i < x.n; i++) top = x.sign * x.value[i] > x.sign * x.value[top] ? i : top;
    return x.when[top];
}

/* The largest until a time, falling; how many. */
static int64_t highest(extremes_t x, double until, double *top)
{
    int64_t k = 0;
    for (int64_t i = 0; i < x.n; i++) {
        const double value = x.sign * x.value[i];
        int64_t j;
        if (!(x.when[i] <= until) || (k == NEAR && value <= top[k - 1])) continue;
        if (k < NEAR) k++;
        for (j = k - 1; j > 0 && top[j - 1] < value; j--) top[j] = top[j - 1];
        top[j] = value;
    }
    return k;
}

/* Largest distance of any of the values from the nearest of the others. */
static double distance(int64_t n, const double *values, int64_t m, const double *others)
{
    double largest = 0.0;
    for (int64_t i = 0; i < n && i < COMPARED; i++) {
        double nearest = HUGE_VAL;
        for (int64_t j = 0; j < m; j++) nearest = fmin(nearest, fabs(values[i] - others[j]));
        largest = fmax(largest, nearest);
    }
    return largest;
}

double difference_of_extremes(int64_t n, const double *when, const double *value, int64_t m, const double *other_when,
                              const double *other_value, int64_t with_impacts, double guard_share, double same_until)
{
    double worst = 0.0, x[NEAR], y[NEAR];
    for (double sign = 1.0; sign >= -1.0; sign -= 2.0) {
        const extremes_t a = {n, when, value, sign}, b = {m, other_when, other_value, sign};
        const double of_a = time_of_largest(a), of_b = time_of_largest(b), last = fmax(of_a, of_b);
        const double share = last < same_until ? guard_share : 1.0, until = fmax(last, same_until);
        for (int alone = 0; alone <= (with_impacts != 0); alone++) {
            const int64_t k = highest(a, alone ? of_a : until, x), l = highest(b, alone ? of_b : until, y);
            worst = fmax(worst, fabs(x[0] - y[0]));
            worst = fmax(worst, share * fmax(distance(k, x, l, y), distance(l, y, k, x)));
        }
    }
    return worst;
}
