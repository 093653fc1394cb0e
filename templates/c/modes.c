/* Sines, bounds and NaN hold in IEEE arithmetic only, with every operation as it is written. */
#if defined(__FAST_MATH__) || defined(_M_FP_FAST) || defined(__ASSOCIATIVE_MATH__) \
    || defined(__RECIPROCAL_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "compile without -ffast-math, -Ofast, -funsafe-math-optimizations, -freciprocal-math, \
-ffinite-math-only and /fp:fast: they change the values of these functions"
#endif
#if defined(__clang__) && __clang_major__ > 10 /* no macro says that it may reassociate */
#pragma clang fp reassociate(off)
#endif
