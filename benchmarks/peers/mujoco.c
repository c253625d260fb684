/* MuJoCo behind the interface of loops.h. The model comes from a file that MuJoCo itself saved. */
#include "loops.h"

#include <mujoco/mujoco.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
  mjModel *model;
  mjData *data;
} arm;

static void ignore(const char *warning) { (void)warning; }

/* Some published arms have a singular inertia matrix, of which MuJoCo warns in a log file. */
void quiet(void) { mju_user_warning = ignore; }

void *arm_new(const char *file) {
  arm *self = malloc(sizeof *self);
  self->model = mj_loadModel(file, NULL);
  self->data = self->model ? mj_makeData(self->model) : NULL;
  return self->data ? self : NULL;
}

/* What inverse dynamics needs and nothing else. */
void tau_loop(void *self, size_t count, const double *const *in, double *const *out) {
  const mjModel *model = ((arm *)self)->model;
  mjData *data = ((arm *)self)->data;
  const size_t n = (size_t)model->nv, size = n * sizeof(double);
  for (size_t i = 0; i < count; ++i) {
    memcpy(data->qpos, in[0] + i * n, size);
    memcpy(data->qvel, in[1] + i * n, size);
    memcpy(data->qacc, in[2] + i * n, size);
    mj_kinematics(model, data);
    mj_comPos(model, data);
    mj_comVel(model, data);
    mj_rne(model, data, 1, out[0] + i * n);
  }
}

/* The whole of its inverse dynamics, as its documentation calls it. */
void tau_inverse_loop(void *self, size_t count, const double *const *in, double *const *out) {
  const mjModel *model = ((arm *)self)->model;
  mjData *data = ((arm *)self)->data;
  const size_t n = (size_t)model->nv, size = n * sizeof(double);
  for (size_t i = 0; i < count; ++i) {
    memcpy(data->qpos, in[0] + i * n, size);
    memcpy(data->qvel, in[1] + i * n, size);
    memcpy(data->qacc, in[2] + i * n, size);
    mj_inverse(model, data);
    memcpy(out[0] + i * n, data->qfrc_inverse, size);
  }
}

void inertia_matrix_loop(void *self, size_t count, const double *const *in, double *const *out) {
  const mjModel *model = ((arm *)self)->model;
  mjData *data = ((arm *)self)->data;
  const size_t n = (size_t)model->nv;
  for (size_t i = 0; i < count; ++i) {
    memcpy(data->qpos, in[0] + i * n, n * sizeof(double));
    mj_kinematics(model, data);
    mj_comPos(model, data);
    mj_makeM(model, data);
    mj_fullM(model, data, out[0] + i * n * n);
  }
}
