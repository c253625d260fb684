/* What every compiled contender offers: one function of the dynamics, for many samples in a row. */
#ifndef LOOPS_H
#define LOOPS_H

#include <stddef.h>

/* in[k] and out[k]: the k-th input and result of the function, count rows of one sample each. */
typedef void loop(void *self, size_t count, const double *const *in, double *const *out);

#endif
