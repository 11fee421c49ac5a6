/* Functions of complex numbers for Python under Wine 8, whose C library has none; scripts/windows.py compiles them.
   By their definitions, for tests only: correct to rounding where nothing overflows or cancels. */
#include <math.h>

typedef struct { double a, b; } D;
typedef struct { float a, b; } F;

static D of(double a, double b) { D z = {a, b}; return z; }
static D times(D x, D y) { return of(x.a * y.a - x.b * y.b, x.a * y.b + x.b * y.a); }
static D over(D x, D y) {
    double q = y.a * y.a + y.b * y.b;
    return of((x.a * y.a + x.b * y.b) / q, (x.b * y.a - x.a * y.b) / q);
}
static D plus(D x, D y) { return of(x.a + y.a, x.b + y.b); }
/* i z and z / i */
static D turned(D z) { return of(-z.b, z.a); }
static D back(D z) { return of(z.b, -z.a); }

double my_creal(D z) { return z.a; }
double my_cimag(D z) { return z.b; }
double my_cabs(D z) { return hypot(z.a, z.b); }
double my_carg(D z) { return atan2(z.b, z.a); }
D my_conj(D z) { return of(z.a, -z.b); }
D my_cproj(D z) { return isinf(z.a) || isinf(z.b) ? of(INFINITY, copysign(0, z.b)) : z; }
D my_cexp(D z) { double e = exp(z.a); return z.b == 0 ? of(e, z.b) : of(e * cos(z.b), e * sin(z.b)); }
D my_clog(D z) { return of(log(my_cabs(z)), my_carg(z)); }
D my_cpow(D x, D y) {
    if (x.a == 0 && x.b == 0) return of(y.a == 0 && y.b == 0, 0);
    return my_cexp(times(y, my_clog(x)));
}
D my_csqrt(D z) {
    double m = my_cabs(z), r = sqrt((m + fabs(z.a)) / 2), i;
    if (m == 0) return of(0, z.b);
    i = fabs(z.b) / (2 * r);
    return z.a >= 0 ? of(r, copysign(i, z.b)) : of(i, copysign(r, z.b));
}
D my_csinh(D z) { return of(sinh(z.a) * cos(z.b), cosh(z.a) * sin(z.b)); }
D my_ccosh(D z) { return of(cosh(z.a) * cos(z.b), sinh(z.a) * sin(z.b)); }
D my_ctanh(D z) { return fabs(z.a) > 20 ? of(copysign(1, z.a), 0) : over(my_csinh(z), my_ccosh(z)); }
D my_csin(D z) { return back(my_csinh(turned(z))); }
D my_ccos(D z) { return my_ccosh(turned(z)); }
D my_ctan(D z) { return back(my_ctanh(turned(z))); }
/* log(z + sqrt(z z + 1)) */
D my_casinh(D z) { return my_clog(plus(z, my_csqrt(plus(times(z, z), of(1, 0))))); }
D my_cacosh(D z) {
    return my_clog(plus(z, times(my_csqrt(plus(z, of(1, 0))), my_csqrt(plus(z, of(-1, 0))))));
}
D my_catanh(D z) {
    D p = my_clog(of(1 + z.a, z.b)), m = my_clog(of(1 - z.a, -z.b));
    return of((p.a - m.a) / 2, (p.b - m.b) / 2);
}
D my_casin(D z) { return back(my_casinh(turned(z))); }
D my_cacos(D z) { D s = my_casin(z); return of(acos(-1) / 2 - s.a, -s.b); }
D my_catan(D z) { return back(my_catanh(turned(z))); }

/* In single precision, and in long double, which is double on Windows. */
#define OF_FLOAT(name) \
    F my_##name##f(F x) { D z = my_##name(of(x.a, x.b)); F y = {(float)z.a, (float)z.b}; return y; } \
    D my_##name##l(D z) { return my_##name(z); }
#define REAL_OF_FLOAT(name) \
    float my_##name##f(F x) { return (float)my_##name(of(x.a, x.b)); } \
    double my_##name##l(D z) { return my_##name(z); }
REAL_OF_FLOAT(creal) REAL_OF_FLOAT(cimag) REAL_OF_FLOAT(cabs) REAL_OF_FLOAT(carg)
OF_FLOAT(conj) OF_FLOAT(cproj) OF_FLOAT(cexp) OF_FLOAT(clog) OF_FLOAT(csqrt)
OF_FLOAT(csinh) OF_FLOAT(ccosh) OF_FLOAT(ctanh) OF_FLOAT(csin) OF_FLOAT(ccos) OF_FLOAT(ctan)
OF_FLOAT(casinh) OF_FLOAT(cacosh) OF_FLOAT(catanh) OF_FLOAT(casin) OF_FLOAT(cacos) OF_FLOAT(catan)
F my_cpowf(F x, F y) { D z = my_cpow(of(x.a, x.b), of(y.a, y.b)); F r = {(float)z.a, (float)z.b}; return r; }
D my_cpowl(D x, D y) { return my_cpow(x, y); }
