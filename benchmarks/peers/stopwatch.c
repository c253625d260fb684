/* Times a loop over all states, in batches of count, passes times over.
 *
 * Counted is the time that the thread spends on the processor, not while another one has it.
 *
 * With dependent set, where the inputs of a batch are depends on the last batch's result (on nothing
 * but its being there), so that the processor cannot begin with the next before the last is done.
 */
#define _POSIX_C_SOURCE 199309L
#include "loops.h"

#include <time.h>

enum { MOST = 8 };

double stopwatch(loop *measured, void *self, size_t inputs, const size_t *in_sizes,
                 const double *const *in, size_t outputs, const size_t *out_sizes,
                 double *const *out, size_t states, size_t count, size_t passes,
                 int dependent) {
  struct timespec start, stop;
  const double *from[MOST];
  double *to[MOST];
  size_t nothing = 0;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &start);
  for (size_t pass = 0; pass < passes; ++pass) {
    for (size_t first = 0; first + count <= states; first += count) {
      for (size_t k = 0; k < inputs; ++k) from[k] = in[k] + (first + nothing) * in_sizes[k];
      for (size_t k = 0; k < outputs; ++k) to[k] = out[k] + first * out_sizes[k];
      measured(self, count, from, to);
      if (dependent) nothing = (size_t)(long)(0.0 * to[0][0]);
    }
  }
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &stop);
  return (double)(stop.tv_sec - start.tv_sec) + 1e-9 * (double)(stop.tv_nsec - start.tv_nsec);
}
