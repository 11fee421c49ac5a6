/* Torque against speed as piecewise cubics: through points, their values, their slopes. */
#include <math.h>
#include "kernels.h"
#include "segment.h"

static double sign(double x) { return (double)((x > 0.0) - (x < 0.0)); }

/* Slope at an end: the three-point formula, limited. */
static double end_slope(double width, double next_width, double chord, double next_chord)
{
    const double slope = ((2.0 * width + next_width) * chord - width * next_chord) / (width + next_width);
    if (sign(slope) != sign(chord)) return 0.0;
    if (sign(chord) != sign(next_chord) && fabs(slope) > 3.0 * fabs(chord)) return 3.0 * chord;
    return slope;
}

/* Slope at a point between two chords: zero at an extreme, else their weighted harmonic mean. */
static double inner_slope(double before, double after, double chord, double next_chord)
{
    const double w_before = 2.0 * after + before, w_after = after + 2.0 * before;
    if (!(sign(chord) * sign(next_chord) > 0.0)) return 0.0;
    return 1.0 / ((w_before / chord + w_after / next_chord) / (w_before + w_after));
}

/* Cubics (n, 4) from each point on; they rise and fall only where the points do. The last one is constant. */
void curve_through(int64_t n, const double *x, const double *y, double *cubics)
{
#define WIDTH(i) (x[(i) + 1] - x[i])
#define CHORD(i) ((y[(i) + 1] - y[i]) / WIDTH(i))
    double slope = 0.0;
    if (n == 2) slope = CHORD(0);
    if (n > 2) slope = end_slope(WIDTH(0), WIDTH(1), CHORD(0), CHORD(1));
    for (int64_t i = 0; i + 1 < n; i++) {
        const double width = WIDTH(i), chord = CHORD(i);
        double next = chord, bend;
        if (i + 2 < n) next = inner_slope(width, WIDTH(i + 1), chord, CHORD(i + 1));
        else if (n > 2) next = end_slope(width, WIDTH(i - 1), chord, CHORD(i - 1));
        bend = (slope + next - 2.0 * chord) / width;
        cubics[4 * i] = y[i];
        cubics[4 * i + 1] = slope;
        cubics[4 * i + 2] = (chord - slope) / width - bend;
        cubics[4 * i + 3] = bend / width;
        slope = next;
    }
    cubics[4 * (n - 1)] = y[n - 1];
    for (int j = 1; j < 4; j++) cubics[4 * (n - 1) + j] = 0.0;
#undef WIDTH
#undef CHORD
}

/* Values at n places; outside its knots a curve is constant. */
void curve_values(int64_t n_knots, const double *knots, const double *cubics, int64_t n, const double *x, double *out)
{
    const int64_t last = n_knots - 1;
    int64_t k = 0;
    for (int64_t i = 0; i < n; i++) {
        const double at = x[i] < knots[0] ? knots[0] : x[i] > knots[last] ? knots[last] : x[i];
        const double *c;
        double s;
        if (!(k < last && knots[k] <= at && at < knots[k + 1])) k = at >= knots[last] ? last : segment(knots, n_knots, at);
        s = at - knots[k];
        c = cubics + 4 * k;
        out[i] = c[0] + s * (c[1] + s * (c[2] + s * c[3]));
    }
}

/* Largest magnitude of the slope. */
double curve_steepest(int64_t n_knots, const double *knots, const double *cubics)
{
    double steepest = 0.0;
    for (int64_t i = 0; i + 1 < n_knots; i++) {
        const double width = knots[i + 1] - knots[i], *p = cubics + 4 * i, b = p[1], c = p[2], d = p[3];
        const double turn = d != 0.0 ? -c / (3.0 * d) : 0.0; /* the slope is a parabola */
        const double at[] = {0.0, turn > 0.0 ? (turn < width ? turn : width) : 0.0, width};
        for (int j = 0; j < 3; j++) {
            const double slope = fabs(b + at[j] * (2.0 * c + 3.0 * d * at[j]));
            steepest = slope > steepest ? slope : steepest;
        }
    }
    return steepest;
}
