/* Vectors of doubles for every kernel of the project, with the vector extensions of GCC and Clang: as wide as the lanes that the
 * compiler is told of (native.py names them). A "lane" is one case or one design; nothing that happens in a
 * lane depends on the others.
 */
#ifndef FLEXSTAGE_LANES_H
#define FLEXSTAGE_LANES_H
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#ifdef FLEXSTAGE_SOURCES
/* Digests of what a library is built from: of its sources, compared when it is loaded, and of all, compared when it would be built again. */
const char *const flexstage_sources = FLEXSTAGE_SOURCES, *const flexstage_build = FLEXSTAGE_BUILD;
#endif

#if defined(__AVX512F__)
#define WIDTH 8
#elif defined(__AVX__)
#define WIDTH 4
#else
#define WIDTH 2 /* SSE2, NEON */
#endif

typedef double lanes __attribute__((vector_size(WIDTH * 8)));
typedef int64_t marks __attribute__((vector_size(WIDTH * 8)));

static inline lanes all(double x) { lanes r; for (int i = 0; i < WIDTH; i++) r[i] = x; return r; }
static inline lanes pick(marks m, lanes a, lanes b) { return (lanes)((m & (marks)a) | (~m & (marks)b)); }
static inline lanes size_of(lanes a) { return (lanes)((marks)a & INT64_MAX); }
static inline int any(marks m) { int64_t s = 0; for (int i = 0; i < WIDTH; i++) s |= m[i]; return s != 0; }
#endif
