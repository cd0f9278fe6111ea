/* A driver of CUDA without a card: libcuda.so.1 with the functions that raycost calls. The PTX that it gets becomes
   C++ (ptx.py), which it compiles, and whose kernels it runs, one item after the other. CARD names a folder for the
   compiled programs; each is made once. FAULT names a fault:
     none    there is no device
     fuses   products and sums are fused
     memory  has memory for arrays of up to 64 KiB
     lost    is lost at the 20th launch
     hangs   never finishes the 20th launch */
#include <dlfcn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <mutex>
#include <string>

typedef std::chrono::steady_clock Clock;

namespace {
enum {
  OUT_OF_MEMORY = 2,
  NO_DEVICE = 100,
  INVALID_CONTEXT = 201,
  INVALID_PTX = 218,
  NOT_FOUND = 500,
  NOT_READY = 600,
  LAUNCH_FAILED = 719
};

struct Event {
  Clock::time_point time;
  bool is_hung;
};

std::mutex lock;
int n_launches;
/* The context of this thread: most calls need one. */
thread_local void *current;

bool is(const char *fault) {
  const char *asked = getenv("FAULT");
  return asked && !strcmp(asked, fault);
}

bool is_late() { return n_launches >= 20; }
}  // namespace

extern "C" {
int cuInit(unsigned) { return is("none") ? NO_DEVICE : 0; }
/* NVRTC asks for tables of hidden functions. */
int cuGetExportTable(const void **, const void *) { return NOT_FOUND; }
int cuDriverGetVersion(int *version) { return *version = 12040, 0; }

int cuGetErrorName(int error, const char **name) {
  switch (error) {
    case OUT_OF_MEMORY: *name = "CUDA_ERROR_OUT_OF_MEMORY"; break;
    case NO_DEVICE: *name = "CUDA_ERROR_NO_DEVICE"; break;
    case INVALID_CONTEXT: *name = "CUDA_ERROR_INVALID_CONTEXT"; break;
    case INVALID_PTX: *name = "CUDA_ERROR_INVALID_PTX"; break;
    case NOT_FOUND: *name = "CUDA_ERROR_NOT_FOUND"; break;
    case LAUNCH_FAILED: *name = "CUDA_ERROR_LAUNCH_FAILED"; break;
    default: *name = nullptr; return 1;
  }
  return 0;
}

int cuDeviceGetCount(int *n) { return *n = 1, 0; }
int cuDeviceGet(int *device, int) { return *device = 0, 0; }
int cuDeviceGetName(char *name, int size, int) { return snprintf(name, size, "executed PTX"), 0; }
int cuDeviceTotalMem_v2(size_t *n, int) { return *n = (size_t)1 << 30, 0; }

int cuDeviceGetAttribute(int *value, int attribute, int) {
  switch (attribute) {
    case 10: *value = 32; return 0;  /* CU_DEVICE_ATTRIBUTE_WARP_SIZE */
    case 39: *value = 2048; return 0; /* CU_DEVICE_ATTRIBUTE_MAX_THREADS_PER_MULTIPROCESSOR */
    case 75: *value = 9; return 0;   /* CU_DEVICE_ATTRIBUTE_COMPUTE_CAPABILITY_MAJOR */
    case 76: *value = 0; return 0;
    default: return 1;
  }
}

int cuDevicePrimaryCtxRetain(void **context, int) { return *context = &lock, 0; }
int cuDevicePrimaryCtxRelease_v2(int) { return 0; }
int cuCtxSetCurrent(void *context) { return current = context, 0; }

int cuModuleLoadDataEx(void **module, const char *ptx, unsigned, int *, void **) {
  if (!current) return INVALID_CONTEXT;
  std::lock_guard<std::mutex> guard(lock);
  const char *folder = getenv("CARD");
  if (!folder) return INVALID_PTX;
  std::string base = folder;
  base += "/" + std::to_string(std::hash<std::string>()(ptx)) + (is("fuses") ? "-fused" : "");
  if (access((base + ".so").c_str(), R_OK)) {
    // Under names of its own: other processes may do the same, or load a file that is not yet whole.
    std::string own = base + "." + std::to_string(getpid());
    FILE *file = fopen((own + ".ptx").c_str(), "w");
    if (!file) return INVALID_PTX;
    fputs(ptx, file);
    fclose(file);
    std::string command = "python3 tests/device/ptx.py " + own + ".ptx " + own + ".cpp && c++ -std=c++17 -w -shared ";
    command += "-fPIC -ffp-contract=off -fwrapv -I tests/device " + std::string(is("fuses") ? "-DFUSES " : "");
    command += "-o " + own + ".so " + own + ".cpp && rm " + own + ".cpp";
    command += " && mv " + own + ".ptx " + base + ".ptx && mv " + own + ".so " + base + ".so";
    if (system(command.c_str())) return INVALID_PTX;
  }
  *module = dlopen((base + ".so").c_str(), RTLD_NOW);
  return *module ? 0 : INVALID_PTX;
}

int cuModuleUnload(void *) { return 0; }

int cuModuleGetFunction(void **kernel, void *module, const char *name) {
  return *kernel = dlsym(module, name), *kernel ? 0 : NOT_FOUND;
}

/* CU_FUNC_ATTRIBUTE_NUM_REGS is 4. */
int cuFuncGetAttribute(int *value, int attribute, void *) { return *value = attribute == 4 ? 40 : 0, 0; }
int cuOccupancyMaxActiveBlocksPerMultiprocessor(int *n, void *, int, size_t) { return *n = 16, 0; }

int cuMemAlloc_v2(uint64_t *address, size_t size) {
  if (!current) return INVALID_CONTEXT;
  if (is("memory") && size > 1 << 16) return OUT_OF_MEMORY;
  *address = (uint64_t)malloc(size);
  return *address ? 0 : OUT_OF_MEMORY;
}

/* Waits for the launches of all threads. */
int cuMemFree_v2(uint64_t address) {
  while (is("hangs") && is_late()) sleep(1);
  return free((void *)address), 0;
}
int cuMemcpyHtoDAsync_v2(uint64_t to, const void *from, size_t n, void *) { return memcpy((void *)to, from, n), 0; }
int cuMemcpyDtoHAsync_v2(void *to, uint64_t from, size_t n, void *) { return memcpy(to, (void *)from, n), 0; }

int cuStreamCreate(void **stream, unsigned) { return *stream = &lock, current ? 0 : INVALID_CONTEXT; }
int cuStreamDestroy_v2(void *) { return 0; }
int cuEventCreate(Event **event, unsigned) { return *event = new Event(), 0; }
int cuEventDestroy_v2(Event *event) { return delete event, 0; }

int cuEventRecord(Event *event, void *) {
  if (!current) return INVALID_CONTEXT;
  event->time = Clock::now();
  event->is_hung = is("hangs") && is_late();
  return 0;
}

int cuEventQuery(Event *event) { return event->is_hung ? NOT_READY : 0; }

int cuEventElapsedTime(float *ms, Event *begin, Event *end) {
  return *ms = std::chrono::duration<float, std::milli>(end->time - begin->time).count(), 0;
}

int cuLaunchKernel(void *kernel, unsigned n_groups, unsigned, unsigned, unsigned group, unsigned, unsigned, unsigned,
                   void *, void **arguments, void **) {
  if (!current) return INVALID_CONTEXT;
  {
    std::lock_guard<std::mutex> guard(lock);
    if (++n_launches, is("lost") && is_late()) return LAUNCH_FAILED;
  }
  ((void (*)(void **, unsigned, unsigned))kernel)(arguments, n_groups, group);
  return 0;
}
}
