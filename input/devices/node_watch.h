// input/devices/node_watch.h: sleep until nodes come, go or change in a folder, or until another thread calls.
// Milliseconds.
// A NodeWatch is used by one thread; node_watch_wake by any.
#pragma once
#include "base/base.h"

typedef struct NodeWatch {
    int folder_fd; // inotify's; -1: the folder cannot be watched
    int wake_fd;
    const char *prefix; // of the names that count
} NodeWatch;

// `prefix` is borrowed. DEVICE, logged: the system has no descriptors left to wake with. A folder that cannot be
// watched is no failure: see node_watch_sees.
MUST_USE Result node_watch_open(const char *folder, const char *prefix, NodeWatch *watch);
void node_watch_close(NodeWatch *watch);
// Whether changes in the folder end node_watch_wait.
bool node_watch_sees(const NodeWatch *watch);
// At most `timeout_ms`, -1: without end. True: something changed or node_watch_wake was called.
bool node_watch_wait(NodeWatch *watch, int timeout_ms);
void node_watch_wake(const NodeWatch *watch);
