#include "render/timing.h"

#include "base/clock.h"
#include "render/gl.h"

Timing timing_create(bool software) {
    Timing timing = {.software = software};
    if (!software)
        glCreateQueries(GL_TIME_ELAPSED, TIMING_QUERIES, timing.queries);
    return timing;
}

void timing_destroy(Timing *timing) {
    if (!timing->software)
        glDeleteQueries(TIMING_QUERIES, timing->queries);
    *timing = (Timing){0};
}

static void read_oldest(Timing *timing) {
    GLuint64 elapsed_ns = 0;
    glGetQueryObjectui64v(timing->queries[timing->read++ % TIMING_QUERIES], GL_QUERY_RESULT, &elapsed_ns);
    timing->last_ms = (double)elapsed_ns * 1e-6;
}

void timing_begin(Timing *timing) {
    timing->begin_ns = clock_now_ns();
    if (timing->software)
        return;
    if (timing->begun - timing->read == TIMING_QUERIES) // the ring is full
        read_oldest(timing);
    glBeginQuery(GL_TIME_ELAPSED, timing->queries[timing->begun++ % TIMING_QUERIES]);
}

static bool oldest_is_ready(const Timing *timing) {
    GLint ready = GL_FALSE;
    glGetQueryObjectiv(timing->queries[timing->read % TIMING_QUERIES], GL_QUERY_RESULT_AVAILABLE, &ready);
    return ready != GL_FALSE;
}

double timing_end(Timing *timing, bool wait) {
    if (timing->software) {
        glFinish();
        timing->last_ms = (double)(clock_now_ns() - timing->begin_ns) * 1e-6;
        return timing->last_ms;
    }
    glEndQuery(GL_TIME_ELAPSED);
    while (timing->read < timing->begun && (wait || oldest_is_ready(timing)))
        read_oldest(timing);
    return timing->last_ms;
}
