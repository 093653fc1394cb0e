/* Explicit Runge-Kutta steps of many states at once, with any state_derivative_array.
 * This file belongs to whoever generated it, without conditions.
 */

#include <stddef.h>

enum { PART = 32 }; /* numbers that are summed in registers; the size of a state array is a multiple */

typedef void Slopes(size_t, const double *, ptrdiff_t, ptrdiff_t, const double *, ptrdiff_t, ptrdiff_t,
    double *, ptrdiff_t, ptrdiff_t);
typedef void SlopesOfSome(size_t, const double *, ptrdiff_t, ptrdiff_t, const double *, ptrdiff_t, ptrdiff_t,
    const double *, ptrdiff_t, ptrdiff_t, double *, ptrdiff_t, ptrdiff_t);

/* found = y + h (weights[0] slopes[0] + weights[1] slopes[1] + ...); `lost`, if not NULL, is what
   rounding has taken away so far, and is made good (Kahan). */
static void add_up(
    const size_t size, const double *y, const double h, const int count, const double *weights,
    const double *slopes, double *found, double *lost)
{
    for (size_t i = 0; i < size; i += PART) {
        double sum[PART] = { 0 };
        for (int k = 0; k < count; k++) {
            const double *slope = slopes + k * size + i;
            for (int j = 0; weights[k] != 0 && j < PART; j++) {
                sum[j] += weights[k] * slope[j];
            }
        }
        for (int j = 0; j < PART; j++) {
            const double before = y[i + j];
            const double added = lost == NULL ? h * sum[j] : h * sum[j] + lost[i + j];
            found[i + j] = before + added;
            if (lost != NULL) {
                lost[i + j] = added - (found[i + j] - before);
            }
        }
    }
}

/* `steps` steps of length h from the time t, of `count` states of `width` numbers, row after row in
   y. `parameters`, if not NULL, go on by `apart` from one state to the next. The method has `stages`
   nodes, a square of `rows` of weights and the weights `sums`; `room` holds stages + 2 arrays of `size`, zero at first. */
void take_steps(
    void (*const slopes)(void), const size_t count, const size_t width, const size_t size, double *y,
    const double t, const double h, const size_t steps, const double *parameters,
    const ptrdiff_t apart, const int stages, const double *nodes, const double *rows,
    const double *sums, double *room)
{
    double *moved = room + stages * size, *lost = moved + size;
    const ptrdiff_t n = (ptrdiff_t)width;
    for (size_t step = 0; step < steps; step++) {
        for (int k = 0; k < stages; k++) {
            const double now = t + ((double)step + nodes[k]) * h;
            double *found = room + k * size;
            add_up(size, y, h, k, rows + k * stages, room, moved, NULL);
            if (parameters == NULL) {
                ((Slopes *)slopes)(count, &now, 0, 0, moved, n, 1, found, n, 1);
            } else {
                ((SlopesOfSome *)slopes)(
                    count, &now, 0, 0, moved, n, 1, parameters, apart, 1, found, n, 1);
            }
        }
        add_up(size, y, h, stages, sums, room, y, lost);
    }
}
