// Which triangles of a mesh intersect: `check_mesh MESH.obj`. Reads vertices and triangles into two arrays, and gives them to a
// detector. Prints one pair a line, as `sscc check MESH.obj --json` lists them. Faces with more corners are refused. Exit code: 0
// free, 1 colliding, 2 error.
#include <stdio.h>
#include <stdlib.h>

#include "sscc/sscc.h"

// An array that grows.
typedef struct {
  void *data;
  size_t count, capacity;
} array;

static void *push(array *a, size_t size) {
  if (a->count == a->capacity) {
    a->capacity = 2 * a->capacity + 64;
    a->data = realloc(a->data, a->capacity * size);
    if (!a->data) abort();
  }
  return (char *)a->data + size * a->count++;
}

// Reads the lines `v x y z` and `f a b c` of an OBJ file; of `a/t/n` the vertex counts. Returns the reason of a failure, or NULL.
static const char *read_obj(const char *path, array *vertices, array *faces) {
  FILE *file = fopen(path, "r");
  if (!file) return "it cannot be read";
  const char *error = NULL;
  char line[512];
  while (!error && fgets(line, sizeof line, file)) {
    double x[3];
    unsigned v[4];
    if (sscanf(line, "v %lf %lf %lf", &x[0], &x[1], &x[2]) == 3) {
      for (int i = 0; i < 3; ++i) *(double *)push(vertices, sizeof(double)) = x[i];
    } else if (line[0] == 'f' && line[1] == ' ') {
      int corners = sscanf(line, "f %u%*[^ ] %u%*[^ ] %u%*[^ ] %u", &v[0], &v[1], &v[2], &v[3]);
      if (corners < 2) corners = sscanf(line, "f %u %u %u %u", &v[0], &v[1], &v[2], &v[3]);
      if (corners != 3) error = "a face is not a triangle";
      for (int i = 0; i < 3 && !error; ++i) *(uint32_t *)push(faces, sizeof(uint32_t)) = v[i] - 1;
    }
  }
  fclose(file);
  return error;
}

static int fail(void) {
  fprintf(stderr, "error: %s\n", sscc_error_message());
  return 2;
}

static int print_pair(void *user, sscc_pair pair) {
  (void)user;
  printf("%u %u\n", pair.a, pair.b);
  return 0;
}

int main(int count, char **arguments) {
  array vertices = {NULL, 0, 0}, faces = {NULL, 0, 0};
  if (count != 2) {
    fprintf(stderr, "usage: %s MESH.obj\n", arguments[0]);
    return 2;
  }
  const char *error = read_obj(arguments[1], &vertices, &faces);
  if (error) {
    fprintf(stderr, "error: %s: %s\n", arguments[1], error);
    return 2;
  }
  const sscc_matrix positions = {vertices.data, vertices.count / 3, 3, 0, 0};
  const sscc_index_matrix triangles = {faces.data, faces.count / 3, 3, 0, 0};
  sscc_detector *detector = NULL;
  size_t pairs = 0;
  if (sscc_detector_new(positions, triangles, NULL, &detector) != SSCC_STATUS_OK) return fail();
  if (sscc_detector_discrete(detector, positions, &pairs) != SSCC_STATUS_OK) return fail();
  if (sscc_detector_visit_pairs(detector, print_pair, NULL) != SSCC_STATUS_OK) return fail();
  sscc_detector_free(detector);
  free(vertices.data);
  free(faces.data);
  return pairs > 0;
}
