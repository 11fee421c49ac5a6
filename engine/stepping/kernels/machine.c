/* A motor on a train in time: modes and flux linkages advance together.
 *
 * Both are linear but for two couplings: the torque, which the modes take, and what the motion of the rotor does to
 * the fluxes, which they take as voltages. Both linear parts advance exactly; torque and voltages are parabolas through
 * beginning, middle and end of the step (collocation at the points of Lobatto: fourth order), found in rounds.
 */
#include "elementary.h"
#include "kernels.h"
#include <math.h>

enum { POINTS = 3, MOST_ROUNDS = 60 };
/* The rounds of a step end where they change nothing by more, per unit: far below what a step leaves. */
#define SETTLED 1e-12

/* What couples them at one point of a step: voltages [pu] and torque above the one held [N m]. */
typedef struct { double d, q, torque; } inputs_t;

static double row(int64_t n, const double *a, const double *b)
{
    double sum = 0.0;
    for (int64_t i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

static double torque_row(const double *forced, const inputs_t *in)
{
    return forced[0] * in[0].torque + forced[1] * in[1].torque + forced[2] * in[2].torque;
}

/* Voltages of a stator whose axes are connected unlike; e: that of the source, both in the rotor's axes. */
static void unlike_voltages(const machine_t *m, sincos_t axis, double beyond, const double *flux, const double *e,
                            double *u)
{
    const int64_t n = m->n_flux;
    const double *of_d = m->current_rate, *of_q = of_d + n + 3, moved_d = beyond * flux[m->q], moved_q = -beyond * flux[0];
    const double id = row(n, m->current, flux), iq = row(n, m->current + n, flux);
    const double rd = row(n, of_d, flux) + of_d[n] + of_d[n + 1] * moved_d + of_d[n + 2] * moved_q;
    const double rq = row(n, of_q, flux) + of_q[n] + of_q[n + 1] * moved_d + of_q[n + 2] * moved_q;
    const double turning = m->line_omega * (m->axes_speed + beyond), along[2][2] = {{axis.cosine, axis.sine},
                                                                                   {-axis.sine, axis.cosine}};
    double g[2][2], left[2], whole, first, second;
    for (int k = 0; k < 2; k++) {
        const double *terminal = m->rows + 4 * k, c = along[k][0], s = along[k][1];
        const double comes = c * rd + s * rq + turning * (s * id - c * iq);
        left[k] = terminal[2] * (c * e[0] + s * e[1]) - terminal[3] * (c * id + s * iq) - terminal[1] * comes;
        for (int j = 0; j < 2; j++) {
            const double *to = along[j];
            const double gain = c * (of_d[n + 1] * to[0] + of_d[n + 2] * to[1])
                                + s * (of_q[n + 1] * to[0] + of_q[n + 2] * to[1]);
            g[k][j] = (k == j ? terminal[0] : 0.0) + terminal[1] * gain;
        }
    }
    whole = g[0][0] * g[1][1] - g[0][1] * g[1][0];
    first = (left[0] * g[1][1] - g[0][1] * left[1]) / whole;
    second = (g[0][0] * left[1] - left[0] * g[1][0]) / whole;
    u[0] = first * along[0][0] + second * along[1][0];
    u[1] = first * along[0][1] + second * along[1][1];
}

/* Of a voltage that turns, if there is one. */
static sincos_t direction(const double *voltage, double angle)
{
    return voltage[0] != 0.0 ? sin_cos(angle) : (sincos_t){0.0, 0.0};
}

/* Angle and speed are those of the rotor beyond the axes. */
static inputs_t inputs_at(const machine_t *m, double time, double angle, double speed, const double *flux)
{
    const double turned = m->angle + m->pole_pairs * angle, line = m->line_omega * time;
    const double beyond = m->pole_pairs * speed / m->line_omega;
    const sincos_t ahead = direction(m->forward, m->forward[1] + (1.0 - m->axes_speed) * line - turned);
    const sincos_t back = direction(m->backward, m->backward[1] - (1.0 + m->axes_speed) * line - turned);
    const double d = flux[0], q = flux[m->q];
    inputs_t in;
    if (m->current_rate) {
        const sincos_t axis = sin_cos(m->axis - m->axes_speed * line - turned);
        const double e[2] = {m->forward[0] * ahead.cosine, m->forward[0] * ahead.sine};
        double u[2];
        unlike_voltages(m, axis, beyond, flux, e, u);
        in.d = u[0] + beyond * q;
        in.q = u[1] - beyond * d;
    } else {
        in.d = m->forward[0] * ahead.cosine + m->backward[0] * back.cosine + beyond * q;
        in.q = m->forward[0] * ahead.sine + m->backward[0] * back.sine - beyond * d;
    }
    in.torque = d * row(m->n_flux, m->current + m->n_flux, flux) - q * row(m->n_flux, m->current, flux);
    in.torque = m->torque_base * in.torque - m->held;
    return in;
}

static double largest_change(const machine_t *m, inputs_t a, inputs_t b)
{
    return fmax(fmax(fabs(a.d - b.d), fabs(a.q - b.q)), fabs(a.torque - b.torque) / m->torque_base);
}

/* The parabola of the step before, one step on. */
static double onwards(double a, double b, double c, double s)
{
    return a + s * (4.0 * b - 3.0 * a - c + 2.0 * s * (a - 2.0 * b + c));
}

static inputs_t guess(const inputs_t *in, double s)
{
    inputs_t next;
    next.d = onwards(in[0].d, in[1].d, in[2].d, s);
    next.q = onwards(in[0].q, in[1].q, in[2].q, s);
    next.torque = onwards(in[0].torque, in[1].torque, in[2].torque, s);
    return next;
}

/* Inputs in the middle and at the end of a step, and the fluxes there. Returns whether they settled. */
static int settle(const machine_t *m, double time, double h, const double *rotor, const double *base, inputs_t *in,
                  double *flux)
{
    const int64_t n = m->n_flux;
    for (int round = 0; round < MOST_ROUNDS; round++) {
        double change = 0.0;
        inputs_t next[2];
        for (int k = 0; k < 2; k++) {
            const double angle = rotor[2 * k] + torque_row(m->rotor_forced + 6 * k, in);
            const double speed = rotor[2 * k + 1] + torque_row(m->rotor_forced + 6 * k + 3, in);
            for (int64_t i = 0; i < n; i++) {
                const double *forced = m->flux_forced + 6 * (k * n + i);
                double x = base[k * n + i];
                for (int p = 0; p < POINTS; p++) x += forced[2 * p] * in[p].d + forced[2 * p + 1] * in[p].q;
                flux[k * n + i] = x;
            }
            next[k] = inputs_at(m, time + 0.5 * (k + 1) * h, angle, speed, flux + k * n);
        }
        for (int k = 0; k < 2; k++) {
            change = fmax(change, largest_change(m, next[k], in[k + 1]));
            in[k + 1] = next[k];
        }
        if (change <= SETTLED) return 1;
    }
    return 0;
}

int64_t machine_room(const machine_t *m) { return 4 * m->n_flux; }

/* Rows of `state` and `flux` after each step; the first row is given. Returns how many steps were made. */
int64_t advance_machine(int64_t n_steps, double time, double h, const machine_t *m, double *state, double *flux,
                        double *room)
{
    const int64_t size = m->n_blocks * m->block, n = m->n_flux, block = m->block;
    double *base = room, *ahead = room + 2 * n;
    inputs_t in[POINTS];
    for (int64_t step = 0; step < n_steps; step++) {
        const double *x = state + step * size, *psi = flux + step * n, begin = time + (double)step * h;
        double rotor[4], *next = state + (step + 1) * size;
        for (int k = 0; k < 4; k++) rotor[k] = row(size, m->rotor_free + k * size, x);
        for (int64_t i = 0; i < 2 * n; i++) base[i] = m->flux_steady[i] + row(n, m->flux_free + i * n, psi);
        if (step == 0) {
            in[0] = inputs_at(m, begin, row(size, m->rotor, x), row(size, m->rotor + size, x), psi);
            in[1] = in[2] = in[0];
        } else {
            const inputs_t middle = guess(in, 1.5), end = guess(in, 2.0);
            in[0] = in[2];
            in[1] = middle;
            in[2] = end;
        }
        if (!settle(m, begin, h, rotor, base, in, ahead)) return step;
        for (int64_t b = 0; b < m->n_blocks; b++)
            for (int64_t i = 0; i < block; i++) {
                const int64_t at = b * block + i;
                next[at] = row(block, m->free + at * block, x + b * block) + torque_row(m->forced + 3 * at, in);
            }
        for (int64_t i = 0; i < n; i++) flux[(step + 1) * n + i] = ahead[n + i];
    }
    return n_steps;
}
