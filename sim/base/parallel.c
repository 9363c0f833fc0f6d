#include "sim/base/parallel.h"

#include <pthread.h>
#include <stdlib.h>
#include <unistd.h>

#include "sim/base/error.h"
#include "sim/base/progress.h"

enum { THREADS_MAX = 64 };

struct work {
    void (*task)(void *context, size_t index);
    void *context;
    size_t count;
    size_t next;
    const char *name;
    pthread_mutex_t lock;
    size_t done;
};

static void *work_on(void *argument)
{
    struct work *work = argument;
    size_t index = __atomic_fetch_add(&work->next, 1, __ATOMIC_RELAXED);

    while (index < work->count) {
        work->task(work->context, index);
        (void)pthread_mutex_lock(&work->lock);
        progress_show(work->name, ++work->done, work->count);
        (void)pthread_mutex_unlock(&work->lock);
        index = __atomic_fetch_add(&work->next, 1, __ATOMIC_RELAXED);
    }
    return NULL;
}

static size_t cores_to_use(void)
{
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);

    return cores < 1 ? 1 : cores > THREADS_MAX ? THREADS_MAX : (size_t)cores;
}

void in_parallel(const char *name, void (*task)(void *context, size_t index), void *context, size_t count)
{
    struct work work = {.task = task, .context = context, .count = count, .name = name};
    const size_t thread_count = cores_to_use();
    pthread_t threads[THREADS_MAX];

    (void)pthread_mutex_init(&work.lock, NULL);
    for (size_t i = 0; i < thread_count; i++) {
        if (pthread_create(&threads[i], NULL, work_on, &work) != 0) {
            error_line("%s: no thread can be made", name);
            exit(ERROR_EXIT);
        }
    }
    for (size_t i = 0; i < thread_count; i++) {
        (void)pthread_join(threads[i], NULL);
    }
    (void)pthread_mutex_destroy(&work.lock);
    progress_end();
}
