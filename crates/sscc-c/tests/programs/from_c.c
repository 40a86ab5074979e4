// Calls the library from C11: answers, errors, callbacks, threads. Prints "passed".
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sscc/sscc.h"

#define CHECK(condition)                                                                             \
  do {                                                                                               \
    if (!(condition)) {                                                                              \
      fprintf(stderr, "%s:%d: %s (%s)\n", __FILE__, __LINE__, #condition, sscc_error_message());     \
      exit(1);                                                                                       \
    }                                                                                                \
  } while (0)
#define DONE(call) CHECK((call) == SSCC_STATUS_OK)

// Two triangles one unit apart, and a mode that moves the second towards the first.
static const double positions[18] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1};
static const uint32_t faces[6] = {0, 1, 2, 3, 4, 5};
static const double mode[18] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -1, 0, 0, -1, 0, 0, -1};

static sscc_matrix rows(const double *data, size_t count, size_t columns) {
  const sscc_matrix matrix = {data, count, columns, 0, 0};
  return matrix;
}

static sscc_model *model;
static sscc_certificates *certificates;

static int stop(void *user, size_t done, size_t total) {
  CHECK(done <= total);
  ++*(int *)user;
  return 1;
}

static int add(void *user, sscc_pair pair) {
  *(uint32_t *)user += pair.a + pair.b;
  return 0;
}

// Each thread has its own query.
static void *work(void *user) {
  sscc_query *query = NULL;
  DONE(sscc_query_new(model, certificates, &query));
  for (int step = 0; step <= 32; ++step) {
    const double q = step / 16.0;
    size_t count = 9;
    DONE(sscc_query_discrete(query, &q, 1, &count));
    CHECK(count == (step == 16));
  }
  DONE(sscc_query_free(query));
  return user;
}

int main(void) {
  CHECK(sscc_abi_version() == SSCC_ABI_VERSION);
  CHECK(strcmp(sscc_version(), "0.1.0") == 0);
  const sscc_index_matrix triangles = {faces, 2, 3, 0, 0};
  DONE(sscc_model_new(rows(positions, 6, 3), triangles, rows(mode, 18, 1), &model));

  // A callback that cancels, then the certificates.
  int calls = 0;
  CHECK(sscc_certificates_compute(model, NULL, stop, NULL, &calls, &certificates) == SSCC_STATUS_CANCELLED);
  CHECK(calls == 1 && certificates == NULL);
  const sscc_certify_options options = {.size = sizeof options, .threads = 1};
  DONE(sscc_certificates_compute(model, &options, NULL, NULL, NULL, &certificates));
  CHECK(sscc_certificates_root_radius(certificates) > 0.5);

  sscc_query *query = NULL;
  DONE(sscc_query_new(model, certificates, &query));
  double q[1] = {1.0};
  size_t count = 9;
  sscc_pair pair = {7, 7};
  DONE(sscc_query_discrete(query, q, 1, &count));
  CHECK(count == 1);
  CHECK(sscc_query_pairs(query, &pair, 0) == SSCC_STATUS_CAPACITY);
  DONE(sscc_query_pairs(query, &pair, 1));
  CHECK(pair.a == 0 && pair.b == 1);
  uint32_t sum = 0;
  DONE(sscc_query_visit_pairs(query, add, &sum));
  CHECK(sum == 1);
  sscc_statistics statistics;
  DONE(sscc_query_statistics(query, &statistics));
  CHECK(statistics.proof == SSCC_PROOF_SEARCH && statistics.complete == 1);

  const double q0[1] = {0.0}, q1[1] = {2.0};
  sscc_impact impact;
  DONE(sscc_query_continuous(query, q0, q1, 1, &count));
  CHECK(count == 1);
  DONE(sscc_query_impacts(query, &impact, 1));
  CHECK(fabs(impact.time - 0.5) < 1e-9);
  CHECK(sscc_query_discrete(query, q, 2, &count) == SSCC_STATUS_ARGUMENT);
  CHECK(strstr(sscc_error_message(), "q has 2 entries, the model has 1 modes"));
  CHECK(sscc_query_discrete(NULL, q, 1, &count) == SSCC_STATUS_NULL);
  DONE(sscc_query_free(query));

  double moved[18];
  DONE(sscc_model_positions(model, q, 1, moved, 6));
  CHECK(sscc_model_positions(model, moved, 1, moved, 6) == SSCC_STATUS_OVERLAP);
  sscc_detector *detector = NULL;
  const sscc_filter filter = {.size = sizeof filter, .neighbours = SSCC_NEIGHBOURS_INCLUDE_ONE_VERTEX};
  DONE(sscc_detector_new(rows(positions, 6, 3), triangles, &filter, &detector));
  DONE(sscc_detector_discrete(detector, rows(moved, 6, 3), &count));
  CHECK(count == 1);
  DONE(sscc_detector_free(detector));

  pthread_t threads[32];
  for (int i = 0; i < 32; ++i) CHECK(pthread_create(&threads[i], NULL, work, NULL) == 0);
  for (int i = 0; i < 32; ++i) CHECK(pthread_join(threads[i], NULL) == 0);

  DONE(sscc_certificates_free(certificates));
  DONE(sscc_model_free(model));
  DONE(sscc_model_free(NULL));
  puts("passed");
  return 0;
}
