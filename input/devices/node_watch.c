#define _POSIX_C_SOURCE 200809L
#include "input/devices/node_watch.h"

#include "base/log.h"

#include <errno.h>
#include <poll.h>
#include <stdalign.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/inotify.h>
#include <unistd.h>

// udev gives a new node its permissions a moment after it was made: IN_ATTRIB.
#define CHANGES (IN_CREATE | IN_DELETE | IN_ATTRIB | IN_MOVED_TO | IN_MOVED_FROM)

static int watch_folder(const char *folder) {
    int fd = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    if (fd >= 0 && inotify_add_watch(fd, folder, CHANGES) >= 0)
        return fd;
    log_debug("devices: %s cannot be watched (%s); it is looked through once a second instead", folder,
              strerror(errno));
    if (fd >= 0)
        close(fd);
    return -1;
}

Result node_watch_open(const char *folder, const char *prefix, NodeWatch *watch) {
    int wake_fd = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    if (wake_fd < 0) {
        log_error("devices: no file descriptor to wake a thread with: %s", strerror(errno));
        return RESULT_DEVICE;
    }
    *watch = (NodeWatch){.folder_fd = watch_folder(folder), .wake_fd = wake_fd, .prefix = prefix};
    return RESULT_OK;
}

void node_watch_close(NodeWatch *watch) {
    if (watch->folder_fd >= 0)
        close(watch->folder_fd);
    close(watch->wake_fd);
}

bool node_watch_sees(const NodeWatch *watch) {
    return watch->folder_fd >= 0;
}

static bool names_one(const NodeWatch *watch, const char *events, ssize_t bytes) {
    for (ssize_t at = 0; at < bytes;) {
        const struct inotify_event *event = (const void *)(events + at);
        if (event->len > 0 && strncmp(event->name, watch->prefix, strlen(watch->prefix)) == 0)
            return true;
        if (event->mask & IN_Q_OVERFLOW)
            return true;
        at += (ssize_t)(sizeof *event + event->len);
    }
    return false;
}

static bool folder_changed(NodeWatch *watch) {
    alignas(struct inotify_event) char events[4096];
    bool changed = false;
    ssize_t bytes;
    while ((bytes = read(watch->folder_fd, events, sizeof events)) > 0)
        changed |= names_one(watch, events, bytes);
    return changed;
}

static bool was_woken(NodeWatch *watch) {
    uint64_t calls;
    return read(watch->wake_fd, &calls, sizeof calls) > 0;
}

bool node_watch_wait(NodeWatch *watch, int timeout_ms) {
    struct pollfd fds[2] = {{.fd = watch->wake_fd, .events = POLLIN}, {.fd = watch->folder_fd, .events = POLLIN}};
    if (poll(fds, 2, timeout_ms) <= 0)
        return false;
    bool woken = was_woken(watch);
    return (watch->folder_fd >= 0 && folder_changed(watch)) || woken;
}

void node_watch_wake(const NodeWatch *watch) {
    uint64_t once = 1;
    // It fails when as many calls wait as 64 bits count: then it is awake.
    if (write(watch->wake_fd, &once, sizeof once) < 0)
        log_debug("devices: %s", strerror(errno));
}
