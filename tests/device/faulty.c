/* A driver with a fault, named by FAULT: it stands before libOpenCL and passes on what it does not change.
     lies    adds in another way than IEEE 754: one bit of what is read back is flipped
     memory  has memory for arrays of up to 64 KiB
     buffers has memory for input and output of up to 16 KiB after its first launch
     lost    is lost at the 20th launch
     hangs   never finishes the 20th launch
     build   never finishes to compile */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef int (*Launch)(void *, void *, unsigned, const size_t *, const size_t *, const size_t *, unsigned, void *, void *);
typedef int (*Build)(void *, unsigned, const void *, const char *, void *, void *);
typedef int (*Read)(void *, void *, unsigned, size_t, size_t, void *, unsigned, void *, void *);
typedef void *(*Create)(void *, unsigned long, size_t, void *, int *);
typedef int (*Info)(void *, unsigned, size_t, void *, size_t *);

static int n_launches;

static int is(const char *fault) {
  const char *asked = getenv("FAULT");
  return asked && !strcmp(asked, fault);
}

int clEnqueueNDRangeKernel(void *queue, void *kernel, unsigned n, const size_t *offset, const size_t *global,
                           const size_t *local, unsigned n_events, void *events, void *event) {
  if (++n_launches >= 20 && is("lost")) return -36; /* CL_INVALID_COMMAND_QUEUE */
  Launch next = (Launch)dlsym(RTLD_NEXT, "clEnqueueNDRangeKernel");
  return next(queue, kernel, n, offset, global, local, n_events, events, event);
}

int clBuildProgram(void *program, unsigned n, const void *devices, const char *options, void *done, void *data) {
  while (is("build")) sleep(1);
  Build next = (Build)dlsym(RTLD_NEXT, "clBuildProgram");
  return next(program, n, devices, options, done, data);
}

int clEnqueueReadBuffer(void *queue, void *buffer, unsigned blocks, size_t offset, size_t size, void *to,
                        unsigned n_events, void *events, void *event) {
  Read next = (Read)dlsym(RTLD_NEXT, "clEnqueueReadBuffer");
  int error = next(queue, buffer, 1, offset, size, to, n_events, events, event);
  if (is("lies")) ((unsigned char *)to)[size / 2] ^= 1;
  return error;
}

void *clCreateBuffer(void *context, unsigned long flags, size_t size, void *from, int *error) {
  int is_full = flags & 32 ? is("memory") && size > 1 << 16 /* CL_MEM_COPY_HOST_PTR */
                           : is("buffers") && size > 1 << 14 && n_launches > 0;
  if (is_full) {
    *error = -4; /* CL_MEM_OBJECT_ALLOCATION_FAILURE */
    return NULL;
  }
  Create next = (Create)dlsym(RTLD_NEXT, "clCreateBuffer");
  return next(context, flags, size, from, error);
}

int clGetEventInfo(void *event, unsigned what, size_t size, void *value, size_t *n) {
  Info next = (Info)dlsym(RTLD_NEXT, "clGetEventInfo");
  int error = next(event, what, size, value, n);
  if (n_launches >= 20 && is("hangs") && value) *(int *)value = 1; /* CL_RUNNING */
  return error;
}
