#define _POSIX_C_SOURCE 200809L
#include "input/devices/devices_hid.h"

#include "base/clock.h"
#include "base/log.h"
#include "input/devices/device_text.h"
#include "input/devices/node_watch.h"
#include "input/hid/hid_descriptor.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <hidapi.h>

#define NODES_MAX 64     // of all HID devices, keyboards included
#define READ_WAIT_MS 100 // how long a reader takes to notice that it shall end
#define RESCAN_MS 1000   // where the folder cannot be watched, or a device could not be read

// After something changed in /dev: once udev has most likely done its work, and again when it surely has.
static const int settle_ms[] = {50, RESCAN_MS};

typedef enum NodeState {
    NODE_NONE,    // an unused row
    NODE_NEW,     // not tried yet
    NODE_IGNORED, // a keyboard, a mouse, or a descriptor that makes no sense
    NODE_READ,    // it has a reader
    NODE_DENIED,  // it is a pad and cannot be opened; it may have a slot
} NodeState;

typedef struct HidNode {
    NodeState state;
    HidSource *source;
    PadInfo info;
    HidDescriptor *descriptor; // of pads
    size_t report_bytes;       // the longest
    int slot;                  // -1: none
    int64_t found_ns;
    bool seen;  // in the enumeration that runs
    bool asked; // whether opening it failed before
    // Of NODE_READ:
    hid_device *device;
    pthread_t reader;
    PadState pad;
    bool said_damaged;
    atomic_bool stop, ended;
} HidNode;

struct HidSource {
    DeviceQueue *queue;
    NodeWatch watch;
    pthread_t thread;
    atomic_bool stop, looked;
    bool said_full;
    HidNode nodes[NODES_MAX];
};

// ---- One device ---------------------------------------------------------------------------------------------------

static void take_report(HidNode *node, const uint8_t *report, size_t count, int64_t time_ns) {
    if (hid_report_decode(node->descriptor, report, count, &node->pad)) {
        device_queue_report(node->source->queue, node->slot, time_ns, &node->pad);
    } else if (!node->said_damaged) {
        node->said_damaged = true;
        log_warn("%s, %s: a report of %zu bytes, id %d, is none that the device announced; such are passed over",
                 node->info.name, node->info.path, count, report[0]);
    }
}

// hidapi has nothing to wake a reader with, so it wakes by itself now and then.
static void *read_reports(void *argument) {
    HidNode *node = argument;
    uint8_t report[HID_REPORT_BYTES_MAX];
    int count = 0;
    while (count >= 0 && !atomic_load(&node->stop)) {
        count = hid_read_timeout(node->device, report, node->report_bytes, READ_WAIT_MS);
        if (count > 0)
            take_report(node, report, (size_t)count, clock_now_ns());
    }
    if (count < 0) {
        device_queue_leave(node->source->queue, node->slot);
        node->slot = -1;
        log_info("%s, %s: gone", node->info.name, node->info.path);
    }
    atomic_store(&node->ended, true);
    node_watch_wake(&node->source->watch);
    return NULL;
}

static void say_full(HidSource *source, const PadInfo *info) {
    if (!source->said_full)
        log_warn("%s, %s: not used, %d devices are there already", info->name, info->path, DEVICES_MAX);
    source->said_full = true;
}

// The device's slot, told to the queue; false when all are taken.
static bool join(HidNode *node, int error) {
    if (node->slot >= 0)
        device_queue_change(node->source->queue, node->slot, &node->info, error);
    else
        node->slot = device_queue_join(node->source->queue, &node->info, error);
    if (node->slot < 0)
        say_full(node->source, &node->info);
    return node->slot >= 0;
}

static void deny(HidNode *node, int error) {
    bool may_be_early = node->found_ns > 0 && clock_now_ns() - node->found_ns < (int64_t)RESCAN_MS * 1000000;
    node->state = NODE_DENIED;
    if (node->asked || may_be_early)
        return;
    node->asked = true;
    if (join(node, error)) {
        char text[DEVICE_TEXT_BYTES];
        device_text_denied(&node->info, error, text);
        log_warn("%s", text);
    }
}

static bool start_reader(HidNode *node) {
    atomic_store(&node->stop, false);
    atomic_store(&node->ended, false);
    node->pad = pad_at_rest();
    node->state = NODE_READ;
    if (pthread_create(&node->reader, NULL, read_reports, node) == 0)
        return true;
    log_error("%s, %s: no thread to read it with", node->info.name, node->info.path);
    device_queue_leave(node->source->queue, node->slot);
    node->slot = -1;
    hid_close(node->device);
    node->state = NODE_IGNORED;
    return false;
}

// hidapi does not tell why it cannot open a node, so the node is asked first.
static void try_open(HidNode *node) {
    if (access(node->info.path, R_OK | W_OK) != 0) {
        deny(node, errno);
        return;
    }
    node->device = hid_open_path(node->info.path);
    if (!node->device) {
        deny(node, EIO);
        return;
    }
    if (!join(node, 0)) {
        hid_close(node->device);
        node->state = NODE_DENIED;
    } else if (start_reader(node)) {
        char text[DEVICE_TEXT_BYTES];
        device_text_summary(&node->info, text);
        log_info("%s", text);
    }
}

static void end_reader(HidNode *node) {
    atomic_store(&node->stop, true);
    pthread_join(node->reader, NULL);
    hid_close(node->device);
}

static void drop(HidNode *node) {
    if (node->state == NODE_READ)
        end_reader(node);
    if (node->slot >= 0)
        device_queue_leave(node->source->queue, node->slot);
    free(node->descriptor);
    *node = (HidNode){.state = NODE_NONE, .slot = -1};
}

// ---- What nodes there are -----------------------------------------------------------------------------------------

// hidapi 0.13 does not hand the report descriptor out; the kernel does, to everybody.
static size_t read_descriptor(const char *path, uint8_t bytes[HID_DESCRIPTOR_BYTES_MAX]) {
    char file[PAD_PATH_BYTES + 64];
    const char *name = strrchr(path, '/');
    snprintf(file, sizeof file, "/sys/class/hidraw/%s/device/report_descriptor", name ? name + 1 : path);
    int fd = open(file, O_RDONLY | O_CLOEXEC);
    if (fd < 0)
        return 0;
    size_t count = 0;
    ssize_t got;
    while (count < HID_DESCRIPTOR_BYTES_MAX && (got = read(fd, bytes + count, HID_DESCRIPTOR_BYTES_MAX - count)) > 0)
        count += (size_t)got;
    close(fd);
    return count;
}

static size_t longest_report(const HidDescriptor *descriptor) {
    size_t longest = 1;
    for (size_t id = 0; id < COUNT_OF(descriptor->report_bytes); id++)
        if (descriptor->report_bytes[id] > longest)
            longest = descriptor->report_bytes[id];
    return longest < HID_REPORT_BYTES_MAX ? longest : HID_REPORT_BYTES_MAX;
}

// What the node is; NODE_NONE where that cannot be told yet.
static NodeState classify(HidNode *node) {
    uint8_t bytes[HID_DESCRIPTOR_BYTES_MAX];
    size_t count = read_descriptor(node->info.path, bytes);
    node->descriptor = count > 0 ? malloc(sizeof *node->descriptor) : NULL;
    if (!node->descriptor)
        return NODE_NONE;
    if (hid_descriptor_parse(bytes, count, node->descriptor) == RESULT_OK) {
        hid_describe(node->descriptor, &node->info);
        node->report_bytes = longest_report(node->descriptor);
        return NODE_NEW;
    }
    free(node->descriptor);
    node->descriptor = NULL;
    return NODE_IGNORED;
}

static void name_node(HidNode *node, const struct hid_device_info *found) {
    node->info = (PadInfo){.bus = PAD_BUS_HID, .vendor = found->vendor_id, .product = found->product_id};
    snprintf(node->info.path, sizeof node->info.path, "%s", found->path);
    device_text_name(found->manufacturer_string, found->product_string, &node->info);
}

// Another device may have been given the name of one that went.
static bool is_of(const HidNode *node, const struct hid_device_info *found) {
    return node->state != NODE_NONE && node->info.vendor == found->vendor_id &&
           node->info.product == found->product_id && strcmp(node->info.path, found->path) == 0;
}

static HidNode *find_node(HidSource *source, const struct hid_device_info *found) {
    for (int i = 0; i < NODES_MAX; i++)
        if (is_of(&source->nodes[i], found))
            return &source->nodes[i];
    return NULL;
}

static HidNode *add_node(HidSource *source, const struct hid_device_info *found) {
    for (int i = 0; i < NODES_MAX; i++) {
        HidNode *node = &source->nodes[i];
        if (node->state != NODE_NONE)
            continue;
        *node = (HidNode){.source = source, .slot = -1};
        node->found_ns = atomic_load(&source->looked) ? clock_now_ns() : 0;
        name_node(node, found);
        node->state = classify(node);
        return node;
    }
    return NULL;
}

// hidapi lists a node once for each usage its descriptor opens with: the first stands for it.
static void enumerate(HidSource *source) {
    struct hid_device_info *all = hid_enumerate(0, 0);
    for (int i = 0; i < NODES_MAX; i++)
        source->nodes[i].seen = false;
    for (const struct hid_device_info *found = all; found; found = found->next) {
        HidNode *node = find_node(source, found);
        if (!node)
            node = add_node(source, found);
        if (node)
            node->seen = true;
    }
    hid_free_enumeration(all);
}

static void drop_ended(HidSource *source) {
    for (int i = 0; i < NODES_MAX; i++)
        if (source->nodes[i].state == NODE_READ && atomic_load(&source->nodes[i].ended))
            drop(&source->nodes[i]);
}

static void look(HidSource *source) {
    drop_ended(source);
    enumerate(source);
    for (int i = 0; i < NODES_MAX; i++) {
        HidNode *node = &source->nodes[i];
        if (node->state != NODE_NONE && !node->seen)
            drop(node);
        else if (node->state == NODE_NEW || node->state == NODE_DENIED)
            try_open(node);
    }
    atomic_store(&source->looked, true);
}

// ---- The thread that looks ----------------------------------------------------------------------------------------

static bool must_ask_again(const HidSource *source) {
    for (int i = 0; i < NODES_MAX; i++)
        if (source->nodes[i].state == NODE_DENIED)
            return true;
    return !node_watch_sees(&source->watch);
}

static void *watch_nodes(void *argument) {
    HidSource *source = argument;
    size_t settled = COUNT_OF(settle_ms);
    look(source);
    while (!atomic_load(&source->stop)) {
        bool settles = settled < COUNT_OF(settle_ms);
        int wait_ms = settles ? settle_ms[settled] : must_ask_again(source) ? RESCAN_MS : -1;
        if (node_watch_wait(&source->watch, wait_ms)) {
            settled = 0;
            continue;
        }
        settled += settles;
        look(source);
    }
    for (int i = 0; i < NODES_MAX; i++)
        if (source->nodes[i].state == NODE_READ)
            atomic_store(&source->nodes[i].stop, true);
    for (int i = 0; i < NODES_MAX; i++)
        drop(&source->nodes[i]);
    return NULL;
}

Result hid_source_create(DeviceQueue *queue, HidSource **out) {
    HidSource *source = calloc(1, sizeof *source);
    if (!source) {
        log_error("devices: no memory for %zu bytes", sizeof *source);
        return RESULT_MEMORY;
    }
    source->queue = queue;
    for (int i = 0; i < NODES_MAX; i++)
        source->nodes[i].slot = -1;
    Result result = node_watch_open("/dev", "hidraw", &source->watch);
    if (result != RESULT_OK)
        goto fail;
    if (hid_init() != 0 || pthread_create(&source->thread, NULL, watch_nodes, source) != 0) {
        log_error("devices: hidapi cannot be used: no locale or no thread for it");
        result = RESULT_DEVICE;
        goto fail_watch;
    }
    *out = source;
    return RESULT_OK;
fail_watch:
    node_watch_close(&source->watch);
fail:
    free(source);
    return result;
}

void hid_source_destroy(HidSource **source) {
    if (!*source)
        return;
    atomic_store(&(*source)->stop, true);
    node_watch_wake(&(*source)->watch);
    pthread_join((*source)->thread, NULL);
    hid_exit();
    node_watch_close(&(*source)->watch);
    free(*source);
    *source = NULL;
}

bool hid_source_looked(const HidSource *source) {
    return atomic_load(&source->looked);
}
