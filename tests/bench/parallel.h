/** Work for all cores, with a progress bar. */
#ifndef JOULEPATH_TESTS_BENCH_PARALLEL_H
#define JOULEPATH_TESTS_BENCH_PARALLEL_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "sim/base/progress.h"

enum { PARALLEL_THREADS_MAX = 64 };

struct parallel_work {
    void (*task)(void *context, size_t index);
    void *context;
    size_t count;
    atomic_size_t next;
    const char *name;
    pthread_mutex_t lock;
    size_t done;
};

static void *parallel_work_on(void *argument)
{
    struct parallel_work *work = argument;
    size_t index = atomic_fetch_add(&work->next, 1);

    while (index < work->count) {
        work->task(work->context, index);
        (void)pthread_mutex_lock(&work->lock);
        progress_show(work->name, ++work->done, work->count);
        (void)pthread_mutex_unlock(&work->lock);
        index = atomic_fetch_add(&work->next, 1);
    }
    return NULL;
}

static size_t parallel_threads(void)
{
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);

    return cores < 1 ? 1 : cores > PARALLEL_THREADS_MAX ? PARALLEL_THREADS_MAX : (size_t)cores;
}

/** Does task(context, index) for each index below `count`, in any order. */
static void in_parallel(const char *name, void (*task)(void *context, size_t index), void *context, size_t count)
{
    struct parallel_work work = {.task = task, .context = context, .count = count, .name = name};
    const size_t thread_count = parallel_threads();
    pthread_t threads[PARALLEL_THREADS_MAX];

    (void)pthread_mutex_init(&work.lock, NULL);
    for (size_t i = 0; i < thread_count; i++) {
        if (pthread_create(&threads[i], NULL, parallel_work_on, &work) != 0) {
            (void)fprintf(stderr, "%s: no thread\n", name);
            exit(1);
        }
    }
    for (size_t i = 0; i < thread_count; i++) {
        (void)pthread_join(threads[i], NULL);
    }
    (void)pthread_mutex_destroy(&work.lock);
    progress_end();
}

#endif
