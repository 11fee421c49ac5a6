/* Rainflow count of ASTM E1049-85, 5.4.4: three points at a time. */
#include <math.h>
#include "kernels.h"

/* First and last of n values and the reversals between them, repeats left out; how many, -1 where one is not finite. */
int64_t reversals(int64_t n, const double *x, double *point)
{
    int64_t k = 0;
    int rises = 0;
    for (int64_t i = 0; i < n; i++) {
        if (x[i] - x[i] != 0.0) return -1;
        if (k && x[i] == point[k - 1]) continue;
        if (k > 1 && (x[i] > point[k - 1]) == rises) k--; /* on the way */
        if (k) rises = x[i] > point[k - 1];
        point[k++] = x[i];
    }
    return k;
}

/* The two ends of each cycle and its count, in the order in which cycles close; their number. The points turn at
 * each but the first and the last. What does not close counts as half cycles. `open` holds points that are waiting. */
int64_t rainflow(int64_t n, const double *point, int64_t *first, int64_t *second, double *count, int64_t *open)
{
    int64_t found = 0, low = 0, top = 0; /* waiting: open[low] to open[top - 1] */
    for (int64_t i = 0; i < n; i++) {
        open[top++] = i;
        while (top - low >= 3) {
            int64_t a = open[top - 3], b = open[top - 2], whole = top - low > 3;
            if (fabs(point[i] - point[b]) < fabs(point[b] - point[a])) break;
            first[found] = a;
            second[found] = b;
            count[found++] = whole ? 1.0 : 0.5;
            if (whole) {
                top -= 2;
                open[top - 1] = i;
            } else {
                low++;
            }
        }
    }
    for (; low + 1 < top; low++) {
        first[found] = open[low];
        second[found] = open[low + 1];
        count[found++] = 0.5;
    }
    return found;
}
