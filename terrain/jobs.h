// terrain/jobs.h: a pool of workers that run a function over a range.
// No units.
// The Jobs own their threads; one thread at a time may hand them work.
#pragma once
#include "base/base.h"

typedef struct Jobs Jobs;

// `workers`: threads that work, the calling one counted, 1..64; 1 starts none; 0: one per processor.
MUST_USE Result jobs_create(int workers, Jobs **out);
void jobs_destroy(Jobs **jobs);
int jobs_worker_count(const Jobs *jobs);

// Calls task(user, begin, end, worker) over disjoint pieces of [0, count) until all are done, `grain` items
// at a time, and returns then. Pieces run in any order on any worker: results must not depend on it.
// `worker` is 0..jobs_worker_count-1 and never runs two pieces at a time: an index for scratch memory.
typedef void JobsTask(void *user, int64_t begin, int64_t end, int worker);
void jobs_run(Jobs *jobs, int64_t count, int64_t grain, JobsTask *task, void *user);
