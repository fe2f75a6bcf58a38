/* CUDA C++ as C for the CPU: one block after the other, its threads as coroutines that meet at __syncthreads().

   Each operation rounds as its namesake on a GPU does. What is shared by a block is static. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <ucontext.h>

#define __global__ static
#define __device__
#define __shared__ static
#define __forceinline__ inline
#define __noinline__ __attribute__((noinline))
#define __launch_bounds__(threads)
#define __syncthreads() pause_thread()

#define __dadd_rn(x, y) ((double)(x) + (double)(y))
#define __dsub_rn(x, y) ((double)(x) - (double)(y))
#define __dmul_rn(x, y) ((double)(x) * (double)(y))
#define __fma_rn(x, y, z) fma((x), (y), (z))
#define __fadd_rn(x, y) ((float)(x) + (float)(y))
#define __fsub_rn(x, y) ((float)(x) - (float)(y))
#define __fmul_rn(x, y) ((float)(x) * (float)(y))
#define __fmaf_rn(x, y, z) fmaf((x), (y), (z))

static struct { unsigned x; } threadIdx, blockIdx, blockDim, gridDim;

static inline long long __double_as_longlong(double x) { long long n; memcpy(&n, &x, 8); return n; }
static inline double __longlong_as_double(long long n) { double x; memcpy(&x, &n, 8); return x; }
static inline int __float_as_int(float x) { int n; memcpy(&n, &x, 4); return n; }
static inline float __int_as_float(int n) { float x; memcpy(&x, &n, 4); return x; }

static inline void atomicMin(unsigned long long *least, unsigned long long x) {
    if (x < *least) *least = x;
}

enum { STACK = 1 << 20 };
typedef struct { ucontext_t context; char *stack; int done; } Thread;
static ucontext_t scheduler;
static Thread *running;
static void (*kernel_of_thread)(void);

static void pause_thread(void) { swapcontext(&running->context, &scheduler); }

static void whole_thread(void) {
    kernel_of_thread();
    running->done = 1;
    pause_thread();
}

/* Runs all threads of all blocks, within each block up to the next barrier in turn, the last thread first where
   `backwards`. Returns 1 where some threads end while others wait at a barrier. */
static int run_blocks(void (*kernel)(void), unsigned grid, unsigned block, int backwards) {
    Thread *threads = calloc(block, sizeof *threads);
    int diverged = 0;
    kernel_of_thread = kernel;
    gridDim.x = grid;
    blockDim.x = block;
    for (unsigned k = 0; k < block; ++k) threads[k].stack = malloc(STACK);
    for (blockIdx.x = 0; blockIdx.x < grid; ++blockIdx.x) {
        unsigned ended = 0;
        for (unsigned k = 0; k < block; ++k) {
            getcontext(&threads[k].context);
            threads[k].context.uc_stack.ss_sp = threads[k].stack;
            threads[k].context.uc_stack.ss_size = STACK;
            threads[k].done = 0;
            makecontext(&threads[k].context, whole_thread, 0);
        }
        while (!ended) {
            for (unsigned n = 0; n < block; ++n) {
                threadIdx.x = backwards ? block - 1 - n : n;
                running = &threads[threadIdx.x];
                swapcontext(&scheduler, &running->context);
                ended += running->done;
            }
        }
        diverged |= ended < block;
    }
    for (unsigned k = 0; k < block; ++k) free(threads[k].stack);
    free(threads);
    return diverged;
}
