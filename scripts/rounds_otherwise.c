/* A C library that rounds in its own way: each of these functions is one unit in the last place off, unless its
 * result is a whole number. scripts/same_bits.py preloads it (Linux): no result of a linear train may change.
 * x^1 stays: it is exact in every library.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <math.h>

static double off(double found)
{
    return found == floor(found) || !isfinite(found) ? found : nextafter(found, INFINITY);
}

#define ONE(name) \
    double name(double x) \
    { \
        static double (*own)(double); \
        if (!own) own = (double (*)(double))dlsym(RTLD_NEXT, #name); \
        return off(own(x)); \
    }
#define TWO(name, exact) \
    double name(double x, double y) \
    { \
        static double (*own)(double, double); \
        if (!own) own = (double (*)(double, double))dlsym(RTLD_NEXT, #name); \
        return (exact) ? own(x, y) : off(own(x, y)); \
    }

ONE(sin) ONE(cos) ONE(tan) ONE(asin) ONE(acos) ONE(atan) ONE(sinh) ONE(cosh) ONE(tanh)
ONE(exp) ONE(exp2) ONE(expm1) ONE(log) ONE(log2) ONE(log10) ONE(log1p) ONE(cbrt)
TWO(pow, y == 1.0) TWO(atan2, 0) TWO(hypot, 0)
