/* The program of devices as C++: stands before libOpenCL and passes on all calls, but compiles the program's text with
   the system's C++ compiler and runs its kernels, one item after the other. So the text is C++, too, and the
   compiler's checks of undefined behavior (TWIN_FLAGS) see every path. Needs a device whose buffers are memory of the
   processor: PoCL's. */
#include <dlfcn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <map>
#include <mutex>
#include <string>
#include <vector>

#define NEXT(name) ((decltype(&name))dlsym(RTLD_NEXT, #name))

/* The words of OpenCL C that C++ has not. */
static const char PRELUDE[] = R"(
#include <cmath>
#include <cstring>
using std::floor, std::round, std::sqrt, std::trunc;
typedef unsigned uint;
typedef unsigned long ulong;
#define __kernel extern "C"
#define __global
#define __constant static const
template <typename To, typename From> static To bits(From x) {
  To y;
  static_assert(sizeof x == sizeof y);
  memcpy(&y, &x, sizeof y);
  return y;
}
static uint as_uint(float x) { return bits<uint>(x); }
static float as_float(uint x) { return bits<float>(x); }
static double as_double(ulong x) { return bits<double>(x); }
static ulong as_ulong(double x) { return bits<ulong>(x); }
extern "C" { thread_local size_t item; }
static size_t get_global_id(uint) { return item; }
)";

namespace {
std::mutex lock;
/* The compiled program; the arguments of kernels, with pointers for buffers. */
void *library;
std::map<void *, std::vector<std::string>> arguments;

void compile(const std::string &text) {
  char folder[] = "/tmp/twinXXXXXX";
  if (!mkdtemp(folder)) abort();
  std::string base = std::string(folder) + "/program", source = base + ".cpp";
  FILE *file = fopen(source.c_str(), "w");
  if (!file) abort();
  fputs((PRELUDE + text).c_str(), file);
  fclose(file);
  const char *flags = getenv("TWIN_FLAGS");
  std::string command = "c++ -std=c++17 -O1 -w -ffp-contract=off -shared -fPIC ";
  command += std::string(flags ? flags : "") + " " + source + " -o " + base + ".so";
  if (system(command.c_str())) abort();
  library = dlopen((base + ".so").c_str(), RTLD_NOW);
  if (!library) {
    fprintf(stderr, "%s\n", dlerror());
    abort();
  }
  unlink(source.c_str());
  unlink((base + ".so").c_str());
  rmdir(folder);
}

/* Calls a kernel for one item, with arguments of the size of pointers. */
void call(void *function, const std::vector<uintptr_t> &a) {
  typedef uintptr_t P;
  switch (a.size()) {
    case 3: ((void (*)(P, P, P))function)(a[0], a[1], a[2]); break;
    case 8:
      ((void (*)(P, P, P, P, P, P, P, P))function)(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7]);
      break;
    case 12:
      ((void (*)(P, P, P, P, P, P, P, P, P, P, P, P))function)(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8],
                                                             a[9], a[10], a[11]);
      break;
    default: abort();
  }
}
}  // namespace

extern "C" {
void *clCreateProgramWithSource(void *context, unsigned n, const char **texts, const size_t *lengths, int *error) {
  std::string text;
  for (unsigned i = 0; i < n; i++) text += lengths && lengths[i] ? std::string(texts[i], lengths[i]) : texts[i];
  std::lock_guard<std::mutex> guard(lock);
  compile(text);
  return NEXT(clCreateProgramWithSource)(context, n, texts, lengths, error);
}

int clSetKernelArg(void *kernel, unsigned i, size_t size, const void *value) {
  {
    std::lock_guard<std::mutex> guard(lock);
    std::vector<std::string> &all = arguments[kernel];
    if (all.size() <= i) all.resize(i + 1);
    all[i].assign((const char *)value, size);
  }
  return NEXT(clSetKernelArg)(kernel, i, size, value);
}

int clGetKernelInfo(void *kernel, unsigned what, size_t size, void *value, size_t *n) {
  return NEXT(clGetKernelInfo)(kernel, what, size, value, n);
}

void *clEnqueueMapBuffer(void *queue, void *buffer, unsigned blocks, unsigned long flags, size_t offset, size_t size,
                         unsigned n_events, void *events, void *event, int *error) {
  return NEXT(clEnqueueMapBuffer)(queue, buffer, blocks, flags, offset, size, n_events, events, event, error);
}

int clEnqueueMarker(void *queue, void **event) { return NEXT(clEnqueueMarker)(queue, event); }

int clEnqueueNDRangeKernel(void *queue, void *kernel, unsigned, const size_t *, const size_t *global, const size_t *,
                           unsigned, void *, void **event) {
  char name[64];
  clGetKernelInfo(kernel, 0x1190, sizeof name, name, nullptr); /* CL_KERNEL_FUNCTION_NAME */
  std::vector<uintptr_t> numbers;
  void *function;
  {
    std::lock_guard<std::mutex> guard(lock);
    function = dlsym(library, name);
    for (const std::string &argument : arguments[kernel]) {
      uintptr_t number = 0;
      memcpy(&number, argument.data(), argument.size());
      numbers.push_back(number);
    }
  }
  if (!function) abort();
  size_t *item = (size_t *)dlsym(library, "item");
  for (uintptr_t &number : numbers) {
    if (&number == &numbers.back()) break; /* the number of items */
    int error = 0;
    number = (uintptr_t)clEnqueueMapBuffer(queue, (void *)number, 1, 3, 0, 4, 0, nullptr, nullptr, &error);
    if (error) abort();
  }
  for (*item = 0; *item < global[0]; ++*item) call(function, numbers);
  return clEnqueueMarker(queue, event);
}
}
