/*
 * sscc: exact collision detection for deformable triangle meshes. C interface; C++ has sscc.hpp beside it.
 *
 * OUTCOMES. Functions return a status; sscc_error_message() has the details. If the status is not SSCC_STATUS_OK, no output was
 * written. Some functions return a count, a radius or a text instead. No panic of the library crosses the C interface. Each function
 * states its own errors. Any function also refuses invalid pointers, lengths and numbers (SSCC_STATUS_NULL, _MISALIGNED, _OVERLAP,
 * _ARGUMENT).
 *
 * HANDLES. sscc_X_new, _load, _compute and _clone return a handle, which the caller owns until sscc_X_free. Freeing NULL has no
 * effect. Using a handle after it was freed, or freeing it twice, is undefined behaviour; libraries with debug assertions refuse it
 * with SSCC_STATUS_HANDLE. Handles share the data from which they were made, so they can be freed in any order.
 *
 * ARRAYS. They belong to the caller, have the stated length, and must not change during a call; the library does not use them
 * afterwards. Inputs may be the same array. An output must not overlap an input. NULL is refused unless the length is 0 or the
 * function allows it. Addresses that are not a multiple of the alignment of their type are refused. Texts are UTF-8 and end with 0.
 * Coordinates are in any one unit of length, at most 2^200.
 *
 * ANSWERS. A query, a kinetic query, a detector and a shape keep the pairs of their last answer. There are none before the first
 * answer, after an answer that failed (except with SSCC_STATUS_BUSY), and after sscc_query_safe_scale and sscc_shape_place. Before
 * the first answer `complete` of the statistics is 0.
 *
 * THREADS. Each function states which threads may call it. Models and certificates never change, so any number of threads may use
 * them. A query, a kinetic query, a detector and a shape serve one call at a time, in any thread: make a copy for each thread. Two
 * calls at the same time with one such handle are undefined behaviour; libraries with debug assertions refuse the second with
 * SSCC_STATUS_BUSY. Free a handle only when no call uses it.
 *
 * CALLBACKS. They must return normally, without exceptions or longjmp. sscc.hpp catches exceptions and throws them again.
 *
 * MEMORY. Repeated answers of one query, kinetic query, detector or shape allocate nothing, except sscc_query_safe_scale,
 * detectors that rebuild their hierarchy because its cost has grown, and the rare exact signs of extreme numbers.
 *
 * STABILITY. Within one SSCC_ABI_VERSION functions, constants and structs do not change; later versions of the library
 * add functions and constants, and fields at the end of structs that begin with their size. Programs need not be compiled again.
 */


#ifndef SSCC_H
#define SSCC_H

/* Written from crates/sscc-c by its test `header`: change the code, not this file. */

#include <stddef.h>
#include <stdint.h>

// The ABI version of this header. If sscc_abi_version() returns another number, the program must be compiled again.
#define SSCC_ABI_VERSION 1

// The outcome of a call. Later versions may add values.
enum sscc_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The call succeeded.
  SSCC_STATUS_OK = 0,
  // A callback ended the call.
  SSCC_STATUS_CANCELLED = 1,
  // A pointer that must not be NULL is NULL.
  SSCC_STATUS_NULL = 2,
  // An address is not a multiple of the alignment of its type.
  SSCC_STATUS_MISALIGNED = 3,
  // Two arrays overlap, elements of a matrix overlap or are interleaved, or two handles that must differ are the same.
  SSCC_STATUS_OVERLAP = 4,
  // An argument is invalid, such as a wrong length or a number out of range; or the floating-point mode of the
  // thread is not that of the proofs.
  SSCC_STATUS_ARGUMENT = 5,
  // The pointer is not a live handle of this type. Only libraries with debug assertions detect this.
  SSCC_STATUS_HANDLE = 6,
  // The handle is in use: by the function that called the callback; with debug assertions also by another thread.
  SSCC_STATUS_BUSY = 7,
  // The array is too small for the answer.
  SSCC_STATUS_CAPACITY = 8,
  // The certificates are of another model.
  SSCC_STATUS_OTHER_MODEL = 9,
  // There are more colliding pairs than an answer or certificates can contain, or too many pairs to ignore.
  SSCC_STATUS_TOO_MANY = 10,
  // A file cannot be read or written, or its content is malformed.
  SSCC_STATUS_FILE = 11,
  // A defect of this library occurred; free the handles of the call.
  SSCC_STATUS_INTERNAL = 12,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum sscc_status sscc_status;
#else
typedef int32_t sscc_status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The kind of proof of an answer, apart from exceptions.
enum sscc_proof
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // A traversal of the hierarchy.
  SSCC_PROOF_SEARCH = 0,
  // The root's radius: one comparison.
  SSCC_PROOF_RADIUS = 1,
  // The root's local certificate: the strain of the whole shape.
  SSCC_PROOF_LOCAL = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum sscc_proof sscc_proof;
#else
typedef int32_t sscc_proof;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The metric in which radii are measured, |z| = |S (q - center)|.
enum sscc_metric
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The metric of the model.
  SSCC_METRIC_MODEL = 0,
  // Each mode is scaled by its largest vertex displacement.
  SSCC_METRIC_DISPLACEMENT = 1,
  // Each mode is scaled by its root mean square displacement, weighted by area.
  SSCC_METRIC_MASS = 2,
  // All weights are 1.
  SSCC_METRIC_IDENTITY = 3,
  // S is the diagonal matrix of `scales`.
  SSCC_METRIC_SCALES = 4,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum sscc_metric sscc_metric;
#else
typedef int32_t sscc_metric;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Whether triangles that share vertices count.
enum sscc_neighbours
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Pairs with common vertices never count.
  SSCC_NEIGHBOURS_EXCLUDE = 0,
  // Pairs with exactly one common vertex count when they have another point in common.
  SSCC_NEIGHBOURS_INCLUDE_ONE_VERTEX = 1,
  // Pairs with common vertices count when they have a common point other than these and the edges between them.
  // Doubled faces always count. This is for discrete queries of detectors only.
  SSCC_NEIGHBOURS_INCLUDE_FOLDED = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum sscc_neighbours sscc_neighbours;
#else
typedef int32_t sscc_neighbours;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The kinds of radii that certificates store.
enum sscc_scheme
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Radii of nodes and node pairs, and local certificates.
  SSCC_SCHEME_FULL = 0,
  // One radius for each node, and for each pair of the root's children, which takes little time and memory.
  SSCC_SCHEME_PAPER = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum sscc_scheme sscc_scheme;
#else
typedef int32_t sscc_scheme;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Whether vertices of equal positions (and modes) are one vertex, for adjacency only.
enum sscc_weld
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The default of the mesh: on for files of formats that split vertices (STL, glTF), otherwise off.
  SSCC_WELD_DEFAULT = 0,
  // Vertices of equal positions are one vertex.
  SSCC_WELD_ON = 1,
  // All vertices are different.
  SSCC_WELD_OFF = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum sscc_weld sscc_weld;
#else
typedef int32_t sscc_weld;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Certificates of a model. They never change. Queries share them, and they may be freed before the queries.
typedef struct sscc_certificates sscc_certificates;

// A detector: finds the triangles of a mesh that collide at given positions. Repeated answers allocate nothing.
typedef struct sscc_detector sscc_detector;

// A kinetic query: it gives the answers of a query, and reuses its work while q moves in small steps. After a warm-up,
// answers allocate nothing.
typedef struct sscc_kinetic sscc_kinetic;

// A mesh with its modes. It never changes. Certificates and queries share it, and it may be freed before them.
typedef struct sscc_model sscc_model;

// A query: finds the triangles of a model that collide. Repeated answers allocate nothing.
typedef struct sscc_query sscc_query;

// A model at some q and pose in the world, to be tested against others. Repeated answers allocate nothing.
typedef struct sscc_shape sscc_shape;

// Two triangles, counted from 0. For one mesh the lower number is first, for two meshes the triangle of the first mesh.
typedef struct sscc_pair {
  // The first triangle.
  uint32_t a;
  // The second triangle.
  uint32_t b;
} sscc_pair;

// The contact filter: which pairs of triangles count. Set `size` to `sizeof(sscc_filter)`; all other fields are 0 by default.
typedef struct sscc_filter {
  // `sizeof(sscc_filter)`.
  size_t size;
  // Pairs that never count, in any order.
  const struct sscc_pair *ignored;
  // Number of ignored pairs.
  size_t ignored_count;
  // A group for each triangle (below 65,536). Without groups: NULL, with `groups_count` 0.
  const uint32_t *groups;
  // Number of triangles in `groups`.
  size_t groups_count;
  // 1: pairs within one group do not count, which needs `groups`. 0: groups have no effect.
  int32_t between_groups_only;
  // One of SSCC_WELD_DEFAULT, SSCC_WELD_ON, SSCC_WELD_OFF.
  int32_t weld;
  // One of SSCC_NEIGHBOURS_EXCLUDE, SSCC_NEIGHBOURS_INCLUDE_ONE_VERTEX, SSCC_NEIGHBOURS_INCLUDE_FOLDED.
  int32_t neighbours;
  // Must be 0.
  int32_t reserved;
} sscc_filter;

// Options of certificates. Set `size` to `sizeof(sscc_certify_options)`; all other fields are 0 by default.
typedef struct sscc_certify_options {
  // `sizeof(sscc_certify_options)`.
  size_t size;
  // Relative tolerance of the root's radius, in (0, 1); 0 means 0.1.
  double epsilon;
  // The largest radius, in units of the paper's global radius: finite, at least 1; 0 means 1. It has no effect with
  // SSCC_SCHEME_PAPER.
  double reach;
  // The q from which radii are measured, r numbers. NULL, with `center_count` 0, means q = 0.
  const double *center;
  // Number of entries of `center`.
  size_t center_count;
  // One positive number for each mode, for SSCC_METRIC_SCALES.
  const double *scales;
  // Number of entries of `scales`.
  size_t scales_count;
  // Which pairs count; NULL means the default of the mesh.
  const struct sscc_filter *filter;
  // Memory of the pair tree, in bytes for each triangle; 0 means 64. SSCC_SCHEME_PAPER stores none.
  size_t budget;
  // Memory of local certificates, in bytes for each triangle; 0 means 64. SSCC_SCHEME_PAPER stores none.
  size_t local_budget;
  // The largest number of exceptions (pairs that collide at the centre); 0 means half the number of triangles,
  // rounded up. If more pairs collide there, none is an exception, and nodes that contain one have radius 0.
  size_t max_exceptions;
  // Number of threads, of which at most 1024 are started; 0 means all cores. The certificates are the same for any number.
  size_t threads;
  // One of SSCC_METRIC_MODEL, SSCC_METRIC_DISPLACEMENT, SSCC_METRIC_MASS, SSCC_METRIC_IDENTITY, SSCC_METRIC_SCALES.
  int32_t metric;
  // One of SSCC_SCHEME_FULL, SSCC_SCHEME_PAPER. With SSCC_SCHEME_PAPER both budgets must be 0.
  int32_t scheme;
  // 1: pairs that collide at rest never count, and neither do those within `ignore_rings` rings of them.
  int32_t ignore_rest;
  // Rings around pairs that collide at rest. They have no effect if `ignore_rest` is 0.
  uint32_t ignore_rings;
} sscc_certify_options;

// Receives the progress of a long computation: `done` of `total` steps are finished. It returns another value than 0 to cancel.
//
// Threads of the library call it, never two at a time. It must not throw, and must not free or use the handles of the
// computation.
typedef int (*sscc_progress_fn)(void *user, size_t done, size_t total);

// Returns another value than 0 to cancel. It is called often, so it should be fast. A computation calls it from
// threads of the library, never from two at a time; a query, a kinetic query or a detector calls it from the thread of
// the call. It must not throw, and must not free the handles of the computation or of the call.
typedef int (*sscc_cancel_fn)(void *user);

// A matrix of doubles of the caller: element (i, j) is `data[i * row_stride + j * column_stride]`. Strides are numbers of
// elements. If both are 0, rows have no gaps (`column_stride` 1, `row_stride` the number of columns).
//
// Positions are V x 3; modes are 3V x r, beginning with the rows x, y, z of the first vertex.
typedef struct sscc_matrix {
  // The first element.
  const double *data;
  // Number of rows.
  size_t rows;
  // Number of columns.
  size_t columns;
  // The distance from a row to the next one, in elements.
  size_t row_stride;
  // The distance from a column to the next one, in elements.
  size_t column_stride;
} sscc_matrix;

// A matrix of 32-bit numbers of the caller, with strides as in sscc_matrix. Faces are F x 3: vertices, counted from 0.
typedef struct sscc_index_matrix {
  // The first element.
  const uint32_t *data;
  // Number of rows.
  size_t rows;
  // Number of columns.
  size_t columns;
  // The distance from a row to the next one, in elements.
  size_t row_stride;
  // The distance from a column to the next one, in elements.
  size_t column_stride;
} sscc_index_matrix;

// Two triangles that collide during a motion.
typedef struct sscc_impact {
  // The first triangle.
  uint32_t a;
  // The second triangle.
  uint32_t b;
  // The time of impact, from 0 to 1, never later than the true one.
  double time;
} sscc_impact;

// Receives one pair of an answer. It returns another value than 0 to end the visit. It must not throw.
typedef int (*sscc_visit_fn)(void *user, struct sscc_pair pair);

// The cost of the last answer of a query, a kinetic query or a detector, and the kind of its proof.
typedef struct sscc_statistics {
  // |z| about the centre, rounded up, in the metric of the certificates; for a continuous answer the larger one of
  // start and end; 0 for a detector.
  double norm;
  // Nodes and node pairs that were opened.
  uint64_t opened;
  // Pairs of boxes that were compared.
  uint64_t box_tests;
  // Pairs of triangles that were tested exactly.
  uint64_t triangle_tests;
  // The kind of proof of the answer.
  sscc_proof proof;
  // 1 if all colliding pairs were found, 0 if a limit or an error stopped the search.
  int32_t complete;
} sscc_statistics;

// The pose of a shape: `rotation * x + translation`. The matrix need not be a rotation.
typedef struct sscc_pose {
  // A 3 x 3 matrix, row by row.
  double rotation[9];
  // The translation.
  double translation[3];
} sscc_pose;

// An axis-aligned box.
typedef struct sscc_box {
  // The smallest coordinates.
  double lower[3];
  // The largest coordinates.
  double upper[3];
} sscc_box;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Computes certificates of a model. `options` is NULL for the defaults. `progress` and `cancel` may be NULL; both receive `user`.
// If one of them cancels, the status is SSCC_STATUS_CANCELLED, and there are no certificates.
//
// Errors: SSCC_STATUS_TOO_MANY if more than 16,777,216 pairs collide at rest or at the centre, or if there are too many pairs
// within `ignore_rings`.
//
// Threads: any. The computation starts its own threads.
sscc_status sscc_certificates_compute(const struct sscc_model *model,
                                      const struct sscc_certify_options *options,
                                      sscc_progress_fn progress,
                                      sscc_cancel_fn cancel,
                                      void *user,
                                      struct sscc_certificates **certificates);

// Loads certificates from a *.sscc.safetensors file. The creation of a query checks whether they are of its model.
//
// Errors: SSCC_STATUS_FILE for a file that cannot be read or is malformed; SSCC_STATUS_ARGUMENT for certificates with a clearance,
// which prove nothing about collisions.
//
// Threads: any.
sscc_status sscc_certificates_load(const char *certificates_path,
                                   struct sscc_certificates **certificates);

// Writes certificates to a *.sscc.safetensors file, which appears whole or not at all. Its bytes are those that the command writes.
//
// Errors: SSCC_STATUS_FILE if the file cannot be written.
//
// Threads: any.
sscc_status sscc_certificates_save(const struct sscc_certificates *certificates,
                                   const char *certificates_path);

// Frees certificates. NULL is ignored.
//
// Threads: any, while no other call uses the certificates.
sscc_status sscc_certificates_free(struct sscc_certificates *certificates);

// Returns the root's radius: if |z| of q is below it, the shape is free at q, apart from exceptions. If it is infinite,
// that holds at every q. 0 for NULL.
//
// Threads: any.
double sscc_certificates_root_radius(const struct sscc_certificates *certificates);

// Returns the number of exceptions: pairs that collide at the centre, and that every query tests. 0 for NULL.
//
// Threads: any.
size_t sscc_certificates_exception_count(const struct sscc_certificates *certificates);

// Creates a detector of a mesh (rest positions V x 3, faces F x 3). `filter` is NULL for the default: pairs with a
// common vertex do not count. The arrays are copied. Rest positions determine the hierarchy and, with SSCC_WELD_ON,
// which vertices are welded.
//
// Threads: any.
sscc_status sscc_detector_new(struct sscc_matrix positions,
                              struct sscc_index_matrix faces,
                              const struct sscc_filter *filter,
                              struct sscc_detector **detector);

// Creates a copy for another thread, with the last answer. Copies share the data that does not change.
//
// Threads: one call at a time for each detector.
sscc_status sscc_detector_clone(const struct sscc_detector *detector, struct sscc_detector **copy);

// Frees a detector. NULL is ignored.
//
// Errors: SSCC_STATUS_BUSY in a callback of a call with the detector, which is then not freed.
//
// Threads: one call at a time for each detector.
sscc_status sscc_detector_free(struct sscc_detector *detector);

// Sets a function that later calls check regularly, and that can end them with SSCC_STATUS_CANCELLED; NULL removes it. The function
// and `user` must remain valid as long as the detector has them. A copy has no such function. Set it once, not for each answer: the
// call copies the state of the detector. Short answers may end without a call of the function. Calls with two detectors check the
// function of the first one only.
//
// Threads: one call at a time for each detector.
sscc_status sscc_detector_set_cancel(struct sscc_detector *detector,
                                     sscc_cancel_fn cancel,
                                     void *user);

// Finds all colliding pairs at these positions (V x 3); `count` receives their number. 0 pairs prove that the mesh is free.
// sscc_detector_pairs copies the pairs.
//
// Errors: SSCC_STATUS_TOO_MANY for more than 67,108,864 pairs.
//
// Threads: one call at a time for each detector.
sscc_status sscc_detector_discrete(struct sscc_detector *detector,
                                   struct sscc_matrix positions,
                                   size_t *count);

// Finds at most `limit` colliding pairs at these positions (V x 3), for any limit; which ones is not fixed. If the limit ended the
// search, `complete` of the statistics is 0.
//
// Threads: one call at a time for each detector.
sscc_status sscc_detector_discrete_at_most(struct sscc_detector *detector,
                                           struct sscc_matrix positions,
                                           size_t limit,
                                           size_t *count);

// Finds one colliding pair at these positions (V x 3), and stops there; which one is not fixed. `count` receives 0 or 1, `pair` the
// pair if there is one; `pair` may be NULL.
//
// Threads: one call at a time for each detector.
sscc_status sscc_detector_first(struct sscc_detector *detector,
                                struct sscc_matrix positions,
                                struct sscc_pair *pair,
                                size_t *count);

// Finds all pairs that collide while every vertex moves on a straight line from its position in `x_t0` to that in `x_t1` (V x 3
// each); `count` receives their number. sscc_detector_impacts copies pairs and times.
//
// Errors: SSCC_STATUS_ARGUMENT for a filter with SSCC_NEIGHBOURS_INCLUDE_FOLDED; SSCC_STATUS_TOO_MANY for more than 67,108,864
// pairs.
//
// Threads: one call at a time for each detector.
sscc_status sscc_detector_continuous(struct sscc_detector *detector,
                                     struct sscc_matrix x_t0,
                                     struct sscc_matrix x_t1,
                                     size_t *count);

// Finds all pairs (triangle of this mesh at `x`, triangle of the other one at `y`) that collide; `count` receives
// their number. All such pairs count: the filters of the detectors have no effect. `detector` stores the answer.
// `other` must be a different detector; for a mesh with itself, use a copy.
//
// Errors: SSCC_STATUS_OVERLAP for the same detector twice; SSCC_STATUS_TOO_MANY for more than 67,108,864 pairs.
//
// Threads: one call at a time for each of both detectors.
sscc_status sscc_detector_against(struct sscc_detector *detector,
                                  struct sscc_matrix x,
                                  struct sscc_detector *other,
                                  struct sscc_matrix y,
                                  size_t *count);

// Finds all pairs (triangle of this mesh, triangle of the other one) that collide while every vertex of both moves on a straight
// line; otherwise as sscc_detector_against. sscc_detector_impacts copies pairs and times.
//
// Errors: as sscc_detector_against.
//
// Threads: one call at a time for each of both detectors.
sscc_status sscc_detector_continuous_against(struct sscc_detector *detector,
                                             struct sscc_matrix x_t0,
                                             struct sscc_matrix x_t1,
                                             struct sscc_detector *other,
                                             struct sscc_matrix y_t0,
                                             struct sscc_matrix y_t1,
                                             size_t *count);

// Copies the pairs of the last answer, sorted. `capacity` is the number of pairs that fit into the array.
//
// Errors: SSCC_STATUS_CAPACITY if the answer has more pairs. Then nothing is copied.
//
// Threads: one call at a time for each detector.
sscc_status sscc_detector_pairs(const struct sscc_detector *detector,
                                struct sscc_pair *pairs,
                                size_t capacity);

// Copies the impacts of the last answer, sorted by pair; a discrete answer has none. `capacity` is the number of impacts that fit
// into the array.
//
// Errors: SSCC_STATUS_CAPACITY if the answer has more impacts. Then nothing is copied.
//
// Threads: one call at a time for each detector.
sscc_status sscc_detector_impacts(const struct sscc_detector *detector,
                                  struct sscc_impact *impacts,
                                  size_t capacity);

// Calls `visit` with each pair of the last answer, in order. If it returns another value than 0, the visit ends with
// SSCC_STATUS_CANCELLED. During the visit other calls with this detector are refused with SSCC_STATUS_BUSY.
//
// Threads: one call at a time for each detector.
sscc_status sscc_detector_visit_pairs(const struct sscc_detector *detector,
                                      sscc_visit_fn visit,
                                      void *user);

// Returns the cost of the last answer, and the kind of its proof, in `statistics`.
//
// Threads: one call at a time for each detector.
sscc_status sscc_detector_statistics(const struct sscc_detector *detector,
                                     struct sscc_statistics *statistics);

// Creates a kinetic query of a model and its certificates. It shares both, which may be freed.
//
// Errors: SSCC_STATUS_OTHER_MODEL if the certificates are of another model.
//
// Threads: any.
sscc_status sscc_kinetic_new(const struct sscc_model *model,
                             const struct sscc_certificates *certificates,
                             struct sscc_kinetic **kinetic);

// Creates a copy for another thread, with the last answer. Copies share the data that does not change.
//
// Threads: one call at a time for each kinetic query.
sscc_status sscc_kinetic_clone(const struct sscc_kinetic *kinetic, struct sscc_kinetic **copy);

// Frees a kinetic query. NULL is ignored.
//
// Errors: SSCC_STATUS_BUSY in a callback of a call with the kinetic query, which is then not freed.
//
// Threads: one call at a time for each kinetic query.
sscc_status sscc_kinetic_free(struct sscc_kinetic *kinetic);

// Sets a function that later calls check regularly, and that can end them with SSCC_STATUS_CANCELLED; NULL removes it. The function
// and `user` must remain valid as long as the query has them. A copy has no such function. Set it once, not for each answer: the
// call copies the state of the query. Short answers may end without a call of the function.
//
// Threads: one call at a time for each kinetic query.
sscc_status sscc_kinetic_set_cancel(struct sscc_kinetic *kinetic,
                                    sscc_cancel_fn cancel,
                                    void *user);

// Finds all colliding pairs at q (`rank` numbers); `count` receives their number. 0 pairs prove that the shape is free.
// sscc_kinetic_pairs copies the pairs.
//
// Errors: SSCC_STATUS_TOO_MANY for more than 67,108,864 pairs.
//
// Threads: one call at a time for each kinetic query.
sscc_status sscc_kinetic_discrete(struct sscc_kinetic *kinetic,
                                  const double *q,
                                  size_t rank,
                                  size_t *count);

// Finds all pairs that collide while every vertex moves on a straight line from its position at `q_t0` to that at `q_t1` (`rank`
// numbers each, which may be the same array); `count` receives their number. sscc_kinetic_impacts copies pairs and times.
//
// Errors: SSCC_STATUS_TOO_MANY for more than 67,108,864 pairs.
//
// Threads: one call at a time for each kinetic query.
sscc_status sscc_kinetic_continuous(struct sscc_kinetic *kinetic,
                                    const double *q_t0,
                                    const double *q_t1,
                                    size_t rank,
                                    size_t *count);

// Copies the pairs of the last answer, sorted. `capacity` is the number of pairs that fit into the array.
//
// Errors: SSCC_STATUS_CAPACITY if the answer has more pairs. Then nothing is copied.
//
// Threads: one call at a time for each kinetic query.
sscc_status sscc_kinetic_pairs(const struct sscc_kinetic *kinetic, struct sscc_pair *pairs, size_t capacity);

// Copies the impacts of the last answer, sorted by pair; a discrete answer has none. `capacity` is the number of impacts that fit
// into the array.
//
// Errors: SSCC_STATUS_CAPACITY if the answer has more impacts. Then nothing is copied.
//
// Threads: one call at a time for each kinetic query.
sscc_status sscc_kinetic_impacts(const struct sscc_kinetic *kinetic,
                                 struct sscc_impact *impacts,
                                 size_t capacity);

// Calls `visit` with each pair of the last answer, in order. If it returns another value than 0, the visit ends with
// SSCC_STATUS_CANCELLED. During the visit other calls with this query are refused with SSCC_STATUS_BUSY.
//
// Threads: one call at a time for each kinetic query.
sscc_status sscc_kinetic_visit_pairs(const struct sscc_kinetic *kinetic,
                                     sscc_visit_fn visit,
                                     void *user);

// Returns the cost of the last answer, and the kind of its proof, in `statistics`.
//
// Threads: one call at a time for each kinetic query.
sscc_status sscc_kinetic_statistics(const struct sscc_kinetic *kinetic, struct sscc_statistics *statistics);

// Creates a model of a mesh (positions V x 3, faces F x 3) and its modes (3V x r): the shape at q is `positions + modes * q`. Its
// metric is SSCC_METRIC_DISPLACEMENT. The arrays are copied.
//
// Threads: any.
sscc_status sscc_model_new(struct sscc_matrix positions,
                           struct sscc_index_matrix faces,
                           struct sscc_matrix modes,
                           struct sscc_model **model);

// Loads a model from a file of any format that the command reads: a *.model.safetensors, a glTF file with morph targets, a complete
// .npz, or a mesh or a solid with a file of modes or a folder of target meshes. `FILE#NAME` names one of several meshes of a glTF
// file. Paths are UTF-8; `modes_path` is NULL for files that contain modes. Warnings about the file, names of modes and default
// weights are not returned.
//
// Errors: SSCC_STATUS_FILE for a file that cannot be read or is malformed.
//
// Threads: any.
sscc_status sscc_model_load(const char *model_path,
                            const char *modes_path,
                            struct sscc_model **model);

// Writes a model to a *.model.safetensors file, which appears whole or not at all.
//
// Errors: SSCC_STATUS_FILE if the file cannot be written.
//
// Threads: any.
sscc_status sscc_model_save(const struct sscc_model *model, const char *model_path);

// Frees a model. NULL is ignored.
//
// Threads: any, while no other call uses the model.
sscc_status sscc_model_free(struct sscc_model *model);

// Returns the number of modes r; 0 for NULL.
//
// Threads: any.
size_t sscc_model_rank(const struct sscc_model *model);

// Returns the number of vertices V; 0 for NULL.
//
// Threads: any.
size_t sscc_model_vertex_count(const struct sscc_model *model);

// Returns the number of triangles F; 0 for NULL.
//
// Threads: any.
size_t sscc_model_triangle_count(const struct sscc_model *model);

// Copies the faces: 3 F numbers, three vertices for each triangle, counted from 0. `count` is F.
//
// Errors: SSCC_STATUS_ARGUMENT if `count` is not the number of triangles.
//
// Threads: any.
sscc_status sscc_model_faces(const struct sscc_model *model, uint32_t *faces, size_t count);

// Computes the positions at q (`rank` numbers), bit for bit those to which all answers refer: 3 V numbers, x, y, z of each vertex.
// `count` is V.
//
// Errors: SSCC_STATUS_ARGUMENT if `count` is not the number of vertices.
//
// Threads: any.
sscc_status sscc_model_positions(const struct sscc_model *model,
                                 const double *q,
                                 size_t rank,
                                 double *positions,
                                 size_t count);

// Creates a query of a model and its certificates. It shares both, which may be freed.
//
// Errors: SSCC_STATUS_OTHER_MODEL if the certificates are of another model.
//
// Threads: any.
sscc_status sscc_query_new(const struct sscc_model *model,
                           const struct sscc_certificates *certificates,
                           struct sscc_query **query);

// Creates a copy for another thread, with the last answer. Copies share the data that does not change.
//
// Threads: one call at a time for each query.
sscc_status sscc_query_clone(const struct sscc_query *query, struct sscc_query **copy);

// Frees a query. NULL is ignored.
//
// Errors: SSCC_STATUS_BUSY in a callback of a call with the query, which is then not freed.
//
// Threads: one call at a time for each query.
sscc_status sscc_query_free(struct sscc_query *query);

// Sets a function that later calls check regularly, and that can end them with SSCC_STATUS_CANCELLED; NULL removes it. The function
// and `user` must remain valid as long as the query has them. A copy has no such function. Set it once, not for each answer: the
// call copies the state of the query. Short answers may end without a call of the function.
//
// Threads: one call at a time for each query.
sscc_status sscc_query_set_cancel(struct sscc_query *query,
                                  sscc_cancel_fn cancel,
                                  void *user);

// Finds all colliding pairs at q (`rank` numbers); `count` receives their number. 0 pairs prove that the shape is free.
// sscc_query_pairs copies the pairs.
//
// Errors: SSCC_STATUS_TOO_MANY for more than 67,108,864 pairs.
//
// Threads: one call at a time for each query.
sscc_status sscc_query_discrete(struct sscc_query *query,
                                const double *q,
                                size_t rank,
                                size_t *count);

// Finds at most `limit` colliding pairs at q (`rank` numbers); which ones is not fixed. If the limit ended the search,
// `complete` of the statistics is 0.
//
// Errors: SSCC_STATUS_TOO_MANY for more than 67,108,864 pairs, if `limit` is larger than this number.
//
// Threads: one call at a time for each query.
sscc_status sscc_query_discrete_at_most(struct sscc_query *query,
                                        const double *q,
                                        size_t rank,
                                        size_t limit,
                                        size_t *count);

// Finds one colliding pair at q (`rank` numbers), and stops there; which one is not fixed. `count` receives 0 or 1, `pair` the pair
// if there is one; `pair` may be NULL.
//
// Threads: one call at a time for each query.
sscc_status sscc_query_first(struct sscc_query *query,
                             const double *q,
                             size_t rank,
                             struct sscc_pair *pair,
                             size_t *count);

// Finds all pairs that collide while every vertex moves on a straight line from its position at `q_t0` to that at `q_t1` (`rank`
// numbers each, which may be the same array); `count` receives their number. sscc_query_impacts copies pairs and times.
//
// Errors: SSCC_STATUS_TOO_MANY for more than 67,108,864 pairs.
//
// Threads: one call at a time for each query.
sscc_status sscc_query_continuous(struct sscc_query *query,
                                  const double *q_t0,
                                  const double *q_t1,
                                  size_t rank,
                                  size_t *count);

// Computes a scale s such that the shape is proven free at `center + t (q - center)` for all t in [0, s], with q of `rank` numbers.
// It is 0 if the shape collides at the centre, else infinite if q is the centre or the global radius, up to which radii are
// computed, is infinite. It is at most the scale at which |z| reaches that radius. It takes longer than an answer, and allocates.
//
// Threads: one call at a time for each query.
sscc_status sscc_query_safe_scale(struct sscc_query *query,
                                  const double *q,
                                  size_t rank,
                                  double *scale);

// Copies the pairs of the last answer, sorted. `capacity` is the number of pairs that fit into the array.
//
// Errors: SSCC_STATUS_CAPACITY if the answer has more pairs. Then nothing is copied.
//
// Threads: one call at a time for each query.
sscc_status sscc_query_pairs(const struct sscc_query *query, struct sscc_pair *pairs, size_t capacity);

// Copies the impacts of the last answer, sorted by pair; a discrete answer has none. `capacity` is the number of impacts that fit
// into the array.
//
// Errors: SSCC_STATUS_CAPACITY if the answer has more impacts. Then nothing is copied.
//
// Threads: one call at a time for each query.
sscc_status sscc_query_impacts(const struct sscc_query *query,
                               struct sscc_impact *impacts,
                               size_t capacity);

// Calls `visit` with each pair of the last answer, in order. If it returns another value than 0, the visit ends with
// SSCC_STATUS_CANCELLED. During the visit other calls with this query are refused with SSCC_STATUS_BUSY.
//
// Threads: one call at a time for each query.
sscc_status sscc_query_visit_pairs(const struct sscc_query *query,
                                   sscc_visit_fn visit,
                                   void *user);

// Returns the cost of the last answer, and the kind of its proof, in `statistics`.
//
// Threads: one call at a time for each query.
sscc_status sscc_query_statistics(const struct sscc_query *query, struct sscc_statistics *statistics);

// Creates a shape at q = 0 in its own axes. `certificates` may be NULL; only their hierarchy is used. The shape shares
// both, which may be freed.
//
// Errors: SSCC_STATUS_OTHER_MODEL if the certificates are of another model.
//
// Threads: any.
sscc_status sscc_shape_new(const struct sscc_model *model,
                           const struct sscc_certificates *certificates,
                           struct sscc_shape **shape);

// Creates a copy for another thread, with the last answer. Copies share the data that does not change.
//
// Threads: one call at a time for each shape.
sscc_status sscc_shape_clone(const struct sscc_shape *shape, struct sscc_shape **copy);

// Frees a shape. NULL is ignored.
//
// Errors: SSCC_STATUS_BUSY in a callback of a call with the shape, which is then not freed.
//
// Threads: one call at a time for each shape.
sscc_status sscc_shape_free(struct sscc_shape *shape);

// Deforms the shape by q (`rank` numbers) and moves it by a pose; without a pose (NULL) it is not moved. `bounds` receives a box
// that contains the shape; it may be NULL.
//
// Threads: one call at a time for each shape.
sscc_status sscc_shape_place(struct sscc_shape *shape,
                             const double *q,
                             size_t rank,
                             const struct sscc_pose *pose,
                             struct sscc_box *bounds);

// Finds all pairs (triangle of this shape, triangle of the other one) that collide; `count` receives their number.
// `shape` stores the answer. `bounds` is a finite AABB that contains all compared shapes, or NULL; it affects only the
// time. `other` must be a different shape.
//
// Errors: SSCC_STATUS_OVERLAP for the same shape twice; SSCC_STATUS_ARGUMENT if `bounds` is not finite; SSCC_STATUS_TOO_MANY for
// more than 67,108,864 pairs.
//
// Threads: one call at a time for each of both shapes.
sscc_status sscc_shape_against(struct sscc_shape *shape,
                               struct sscc_shape *other,
                               const struct sscc_box *bounds,
                               size_t *count);

// Copies the pairs of the last answer, sorted. `capacity` is the number of pairs that fit into the array.
//
// Errors: SSCC_STATUS_CAPACITY if the answer has more pairs. Then nothing is copied.
//
// Threads: one call at a time for each shape.
sscc_status sscc_shape_pairs(const struct sscc_shape *shape, struct sscc_pair *pairs, size_t capacity);

// Calls `visit` with each pair of the last answer, in order. If it returns another value than 0, the visit ends with
// SSCC_STATUS_CANCELLED. During the visit other calls with this shape are refused with SSCC_STATUS_BUSY.
//
// Threads: one call at a time for each shape.
sscc_status sscc_shape_visit_pairs(const struct sscc_shape *shape,
                                   sscc_visit_fn visit,
                                   void *user);

// Returns the message of the last failed call of this thread, one line in UTF-8; empty if no call has failed. It is valid until
// the next failure of a call in this thread.
//
// Threads: any; each has its own message.
const char *sscc_error_message(void);

// Returns the version of the library, such as "0.1.0".
//
// Threads: any.
const char *sscc_version(void);

// Returns the SSCC_ABI_VERSION of the library.
//
// Threads: any.
uint32_t sscc_abi_version(void);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* SSCC_H */
