#define _POSIX_C_SOURCE 200809L
#include "input/devices/devices_usb.h"

#include "base/clock.h"
#include "base/log.h"
#include "input/devices/device_text.h"
#include "input/devices/xbox_report.h"

#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

#include <libusb.h>

#define PACKET_BYTES_MAX 64            // of interrupt endpoints at full speed: USB 2.0, section 5.7.3
#define USB_PADS_MAX (2 * DEVICES_MAX) // those that wait for a slot included
#define FAILURES_MAX 10                // reads in a row that fail, until a pad is given up
#define RETRY_NS INT64_C(1000000000)
#define IDLE_NS (60 * RETRY_NS)
#define RUMBLE_S_MAX 10.0
#define CLOSE_NS (RETRY_NS / 2) // that a device may take to confirm that nothing is under way

typedef enum UsbState {
    USB_NONE,    // an unused row
    USB_DENIED,  // there, and not open; it may have a slot
    USB_READ,    // open
    USB_CLOSING, // waits for its transfers to end
} UsbState;

typedef struct UsbPad {
    UsbState state;
    UsbSource *source;
    libusb_device *device; // a reference
    PadInfo info;
    int slot; // -1: none
    bool gone, asked;
    int64_t retry_ns;
    uint8_t interface, endpoint_in, endpoint_out; // out 0: it has none
    // Of USB_READ and USB_CLOSING:
    libusb_device_handle *handle;
    struct libusb_transfer *reading, *shaking;
    bool reading_flies, shaking_flies;
    uint8_t report[PACKET_BYTES_MAX];
    uint8_t rumble[XBOX_RUMBLE_BYTES]; // as sent last
    double low, high;
    int64_t rumble_end_ns;
    PadState pad;
    int failures;
    bool said_damaged;
} UsbPad;

typedef struct Rumble {
    bool asked;
    double low, high;
    int64_t end_ns;
} Rumble;

struct UsbSource {
    DeviceQueue *queue;
    libusb_context *context;
    pthread_t thread;
    atomic_bool stop, looked;
    bool tells_changes; // libusb says what comes and goes
    libusb_hotplug_callback_handle callback;
    libusb_device *arrivals[USB_PADS_MAX]; // references to pads
    int arrival_count;
    UsbPad pads[USB_PADS_MAX];
    bool said_full;
    pthread_mutex_t mutex;
    Rumble asked[DEVICES_MAX]; // by slot; under the mutex
};

// ---- What a device is ---------------------------------------------------------------------------------------------

static bool is_xbox(const struct libusb_interface_descriptor *interface) {
    return interface->bInterfaceClass == XBOX_USB_CLASS && interface->bInterfaceSubClass == XBOX_USB_SUBCLASS &&
           interface->bInterfaceProtocol == XBOX_USB_PROTOCOL;
}

static void take_endpoints(const struct libusb_interface_descriptor *interface, UsbPad *pad) {
    pad->interface = interface->bInterfaceNumber;
    pad->endpoint_in = pad->endpoint_out = 0;
    for (int i = interface->bNumEndpoints - 1; i >= 0; i--) {
        const struct libusb_endpoint_descriptor *endpoint = &interface->endpoint[i];
        if ((endpoint->bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) != LIBUSB_TRANSFER_TYPE_INTERRUPT)
            continue;
        if (endpoint->bEndpointAddress & LIBUSB_ENDPOINT_IN)
            pad->endpoint_in = endpoint->bEndpointAddress;
        else
            pad->endpoint_out = endpoint->bEndpointAddress;
    }
}

// By the class of an interface, which makers of such pads share; what the kernel read is asked, not the device.
static bool find_interface(libusb_device *device, UsbPad *pad) {
    struct libusb_config_descriptor *config = NULL;
    if (libusb_get_active_config_descriptor(device, &config) != 0)
        return false;
    pad->endpoint_in = 0;
    for (int i = 0; i < config->bNumInterfaces && pad->endpoint_in == 0; i++)
        if (config->interface[i].num_altsetting > 0 && is_xbox(&config->interface[i].altsetting[0]))
            take_endpoints(&config->interface[i].altsetting[0], pad);
    libusb_free_config_descriptor(config);
    return pad->endpoint_in != 0;
}

static void read_attribute(libusb_device *device, const char *name, char out[PAD_NAME_BYTES]) {
    uint8_t ports[8];
    char file[256];
    int used = snprintf(file, sizeof file, "/sys/bus/usb/devices/%u", libusb_get_bus_number(device));
    int count = libusb_get_port_numbers(device, ports, (int)sizeof ports);
    for (int i = 0; i < count; i++)
        used += snprintf(file + used, sizeof file - (size_t)used, "%c%u", i == 0 ? '-' : '.', ports[i]);
    snprintf(file + used, sizeof file - (size_t)used, "/%s", name);
    out[0] = '\0';
    FILE *attribute = fopen(file, "re");
    if (!attribute)
        return;
    if (fgets(out, PAD_NAME_BYTES, attribute))
        out[strcspn(out, "\n")] = '\0';
    fclose(attribute);
}

static void describe(libusb_device *device, PadInfo *info) {
    char maker[PAD_NAME_BYTES], product[PAD_NAME_BYTES];
    struct libusb_device_descriptor descriptor;
    libusb_get_device_descriptor(device, &descriptor); // never fails, says its manual
    *info = (PadInfo){.bus = PAD_BUS_USB, .vendor = descriptor.idVendor, .product = descriptor.idProduct};
    snprintf(info->path, sizeof info->path, "/dev/bus/usb/%03u/%03u", libusb_get_bus_number(device),
             libusb_get_device_address(device));
    read_attribute(device, "manufacturer", maker);
    read_attribute(device, "product", product);
    device_text_name_bytes(maker, product, info);
    xbox_describe(info);
}

// ---- Transfers ----------------------------------------------------------------------------------------------------

static void take_report(UsbPad *pad, const uint8_t *bytes, size_t count, int64_t time_ns) {
    XboxMessage message = xbox_report_decode(bytes, count, &pad->pad);
    if (message == XBOX_INPUT && pad->slot >= 0) {
        device_queue_report(pad->source->queue, pad->slot, time_ns, &pad->pad);
    } else if (message == XBOX_DAMAGED && !pad->said_damaged) {
        pad->said_damaged = true;
        log_warn("%s, %s: a report of %zu bytes; expected %d. Such are passed over", pad->info.name, pad->info.path,
                 count, XBOX_REPORT_BYTES);
    }
}

// Whether it is to be read again.
static bool survives(UsbPad *pad, enum libusb_transfer_status status) {
    pad->failures = status == LIBUSB_TRANSFER_COMPLETED ? 0 : pad->failures + 1;
    bool ends = status == LIBUSB_TRANSFER_NO_DEVICE || status == LIBUSB_TRANSFER_CANCELLED;
    if (!ends && pad->failures == FAILURES_MAX)
        log_warn(
            "%s, %s: %d reads in a row failed, the last with status %d; it is given up until it is plugged in again",
            pad->info.name, pad->info.path, FAILURES_MAX, status);
    return !ends && pad->failures < FAILURES_MAX;
}

static void LIBUSB_CALL on_read(struct libusb_transfer *transfer) {
    int64_t time_ns = clock_now_ns();
    UsbPad *pad = transfer->user_data;
    if (transfer->status == LIBUSB_TRANSFER_COMPLETED)
        take_report(pad, transfer->buffer, (size_t)transfer->actual_length, time_ns);
    bool again = pad->state == USB_READ && survives(pad, transfer->status);
    pad->reading_flies = again && libusb_submit_transfer(transfer) == 0;
    pad->gone |= !pad->reading_flies;
}

static void LIBUSB_CALL on_shaken(struct libusb_transfer *transfer) {
    UsbPad *pad = transfer->user_data;
    pad->shaking_flies = false;
}

static void take_asked(UsbPad *pad) {
    UsbSource *source = pad->source;
    pthread_mutex_lock(&source->mutex);
    Rumble *rumble = &source->asked[pad->slot];
    if (rumble->asked) {
        pad->low = rumble->low;
        pad->high = rumble->high;
        pad->rumble_end_ns = rumble->end_ns;
        rumble->asked = false;
    }
    pthread_mutex_unlock(&source->mutex);
}

// What was asked of the device that had this slot before.
static void forget_asked(UsbPad *pad) {
    pthread_mutex_lock(&pad->source->mutex);
    pad->source->asked[pad->slot].asked = false;
    pthread_mutex_unlock(&pad->source->mutex);
}

// One message is under way at a time; the motors keep what they were told until they are told otherwise.
static void shake(UsbPad *pad) {
    uint8_t wanted[XBOX_RUMBLE_BYTES];
    bool on = clock_now_ns() < pad->rumble_end_ns;
    xbox_rumble_encode(on ? pad->low : 0.0, on ? pad->high : 0.0, wanted);
    if (pad->shaking_flies || pad->endpoint_out == 0 || memcmp(wanted, pad->rumble, sizeof wanted) == 0)
        return;
    memcpy(pad->rumble, wanted, sizeof wanted);
    pad->shaking_flies = libusb_submit_transfer(pad->shaking) == 0;
}

// ---- One pad's life -----------------------------------------------------------------------------------------------

static int errno_of(int error) {
    return error == LIBUSB_ERROR_ACCESS                                         ? EACCES
           : error == LIBUSB_ERROR_BUSY                                         ? EBUSY
           : error == LIBUSB_ERROR_NO_DEVICE || error == LIBUSB_ERROR_NOT_FOUND ? ENODEV
                                                                                : EIO;
}

// The device's slot, told to the queue; false when all are taken.
static bool join(UsbPad *pad, int error) {
    UsbSource *source = pad->source;
    if (pad->slot >= 0)
        device_queue_change(source->queue, pad->slot, &pad->info, error);
    else
        pad->slot = device_queue_join(source->queue, &pad->info, error);
    return pad->slot >= 0;
}

static void deny(UsbPad *pad, int error) {
    pad->state = USB_DENIED;
    pad->retry_ns = clock_now_ns() + RETRY_NS;
    if (pad->asked)
        return;
    pad->asked = true;
    if (join(pad, error)) {
        char text[DEVICE_TEXT_BYTES];
        device_text_denied(&pad->info, error, text);
        log_warn("%s", text);
    }
}

static void free_handle(UsbPad *pad) {
    libusb_close(pad->handle);
    libusb_free_transfer(pad->reading);
    libusb_free_transfer(pad->shaking);
    pad->handle = NULL;
    pad->reading = pad->shaking = NULL;
}

static int claim(UsbPad *pad) {
    if (libusb_kernel_driver_active(pad->handle, pad->interface) == 1) {
        libusb_set_auto_detach_kernel_driver(pad->handle, 1);
        log_debug("%s: the kernel's driver lets go of it for as long as it is used here", pad->info.path);
    }
    return libusb_claim_interface(pad->handle, pad->interface);
}

static int start_reading(UsbPad *pad) {
    pad->reading = libusb_alloc_transfer(0);
    pad->shaking = libusb_alloc_transfer(0);
    if (!pad->reading || !pad->shaking)
        return LIBUSB_ERROR_NO_MEM;
    pad->pad = pad_at_rest();
    pad->failures = 0;
    pad->rumble_end_ns = 0;
    xbox_rumble_encode(0.0, 0.0, pad->rumble);
    libusb_fill_interrupt_transfer(pad->reading, pad->handle, pad->endpoint_in, pad->report, (int)sizeof pad->report,
                                   on_read, pad, 0);
    libusb_fill_interrupt_transfer(pad->shaking, pad->handle, pad->endpoint_out, pad->rumble, (int)sizeof pad->rumble,
                                   on_shaken, pad, 1000);
    return libusb_submit_transfer(pad->reading);
}

static int open_pad(UsbPad *pad) {
    if (access(pad->info.path, R_OK | W_OK) != 0)
        return errno;
    int error = libusb_open(pad->device, &pad->handle);
    if (error != 0)
        return errno_of(error);
    error = claim(pad);
    if (error == 0)
        error = start_reading(pad);
    if (error != 0)
        free_handle(pad);
    return error != 0 ? errno_of(error) : 0;
}

// All slots are taken: asked again later.
static void wait_for_slot(UsbPad *pad) {
    UsbSource *source = pad->source;
    pad->retry_ns = clock_now_ns() + RETRY_NS;
    if (!source->said_full)
        log_warn("%s, %s: not used, %d devices are there already; it is when one of them is unplugged", pad->info.name,
                 pad->info.path, DEVICES_MAX);
    source->said_full = true;
}

static void arrive(UsbPad *pad) {
    char text[DEVICE_TEXT_BYTES];
    if (!join(pad, 0)) { // another was faster since there was room
        wait_for_slot(pad);
        return;
    }
    forget_asked(pad);
    device_text_summary(&pad->info, text);
    log_info("%s", text);
}

// Left to others until there is a slot for it.
static void try_open(UsbPad *pad) {
    pad->state = USB_DENIED;
    if (pad->slot < 0 && !device_queue_has_room(pad->source->queue)) {
        wait_for_slot(pad);
        return;
    }
    int error = open_pad(pad);
    if (error != 0) {
        deny(pad, error);
        return;
    }
    pad->reading_flies = true;
    pad->state = USB_READ;
    arrive(pad);
}

static void leave(UsbPad *pad) {
    if (pad->slot < 0)
        return;
    device_queue_leave(pad->source->queue, pad->slot);
    pad->slot = -1;
    if (pad->state == USB_READ && !atomic_load(&pad->source->stop))
        log_info("%s, %s: gone", pad->info.name, pad->info.path);
}

static void begin_close(UsbPad *pad) {
    leave(pad);
    pad->state = USB_CLOSING;
    if (pad->reading_flies)
        libusb_cancel_transfer(pad->reading);
    if (pad->shaking_flies)
        libusb_cancel_transfer(pad->shaking);
}

static void finish_close(UsbPad *pad) {
    if (pad->handle) {
        libusb_release_interface(pad->handle, pad->interface);
        free_handle(pad);
    }
    libusb_unref_device(pad->device);
    *pad = (UsbPad){.state = USB_NONE, .slot = -1};
}

static void serve(UsbPad *pad) {
    if (pad->state == USB_DENIED && pad->gone) {
        leave(pad);
        finish_close(pad);
    } else if (pad->state == USB_DENIED && clock_now_ns() >= pad->retry_ns) {
        try_open(pad);
    } else if (pad->state == USB_READ && pad->gone) {
        begin_close(pad);
    } else if (pad->state == USB_READ && pad->slot < 0) {
        if (clock_now_ns() >= pad->retry_ns)
            arrive(pad);
    } else if (pad->state == USB_READ) {
        take_asked(pad);
        shake(pad);
    }
    if (pad->state == USB_CLOSING && !pad->reading_flies && !pad->shaking_flies)
        finish_close(pad);
}

// ---- What comes and goes ------------------------------------------------------------------------------------------

static UsbPad *find_pad(UsbSource *source, const libusb_device *device) {
    for (int i = 0; i < USB_PADS_MAX; i++)
        if (source->pads[i].state != USB_NONE && source->pads[i].device == device)
            return &source->pads[i];
    return NULL;
}

static void add_pad(UsbSource *source, libusb_device *device) {
    UsbPad found = {.source = source, .device = device, .slot = -1};
    if (!find_interface(device, &found) || find_pad(source, device))
        return;
    for (int i = 0; i < USB_PADS_MAX; i++) {
        if (source->pads[i].state != USB_NONE)
            continue;
        UsbPad *pad = &source->pads[i];
        *pad = found;
        libusb_ref_device(device);
        describe(device, &pad->info);
        try_open(pad);
        return;
    }
}

// While libusb calls, devices must not be opened: they wait until it is done.
static int LIBUSB_CALL on_change(libusb_context *context, libusb_device *device, libusb_hotplug_event event,
                                 void *user) {
    (void)context;
    UsbSource *source = user;
    UsbPad *pad = find_pad(source, device), scratch;
    if (event == LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT && pad)
        pad->gone = true;
    if (event == LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED && source->arrival_count < USB_PADS_MAX &&
        find_interface(device, &scratch))
        source->arrivals[source->arrival_count++] = libusb_ref_device(device);
    return 0;
}

static void take_arrivals(UsbSource *source) {
    for (int i = 0; i < source->arrival_count; i++) {
        add_pad(source, source->arrivals[i]);
        libusb_unref_device(source->arrivals[i]);
    }
    source->arrival_count = 0;
}

static bool is_listed(const UsbPad *pad, libusb_device *const *devices, ssize_t count) {
    for (ssize_t i = 0; i < count; i++)
        if (devices[i] == pad->device)
            return true;
    return false;
}

// Where libusb does not tell.
static void look_at_all(UsbSource *source) {
    libusb_device **devices = NULL;
    ssize_t count = libusb_get_device_list(source->context, &devices);
    for (int i = 0; i < USB_PADS_MAX && count >= 0; i++)
        if (source->pads[i].state != USB_NONE && !is_listed(&source->pads[i], devices, count))
            source->pads[i].gone = true;
    for (ssize_t i = 0; i < count; i++)
        add_pad(source, devices[i]);
    if (devices)
        libusb_free_device_list(devices, 1);
}

static bool ask_for_changes(UsbSource *source) {
    return libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) &&
           libusb_hotplug_register_callback(
               source->context, LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT,
               LIBUSB_HOTPLUG_ENUMERATE, LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY,
               on_change, source, &source->callback) == LIBUSB_SUCCESS;
}

// ---- The thread that talks ----------------------------------------------------------------------------------------

static int64_t next_deadline_ns(const UsbSource *source, int64_t now_ns) {
    int64_t deadline_ns = now_ns + (source->tells_changes ? IDLE_NS : RETRY_NS);
    for (int i = 0; i < USB_PADS_MAX; i++) {
        const UsbPad *pad = &source->pads[i];
        bool waits = pad->state == USB_DENIED || (pad->state == USB_READ && pad->slot < 0);
        int64_t own_ns = waits                                                   ? pad->retry_ns
                         : pad->state == USB_READ && pad->rumble_end_ns > now_ns ? pad->rumble_end_ns
                         : pad->gone                                             ? now_ns
                                                                                 : deadline_ns;
        if (pad->state != USB_NONE && own_ns < deadline_ns)
            deadline_ns = own_ns;
    }
    return deadline_ns;
}

static void handle_events(UsbSource *source, int64_t until_ns) {
    int64_t wait_ns = until_ns - clock_now_ns();
    // Rounded up: a motor must not be looked at just before its time is over.
    int64_t wait_us = wait_ns > 0 ? (wait_ns + 999) / 1000 : 0;
    struct timeval wait = {.tv_sec = wait_us / 1000000, .tv_usec = wait_us % 1000000};
    if (libusb_handle_events_timeout_completed(source->context, &wait, NULL) != 0)
        clock_sleep_until_ns(clock_now_ns() + RETRY_NS / 100); // so that what fails at once is not tried at full speed
}

static void handle_events_until(UsbSource *source, bool (*done)(const UsbSource *), int64_t until_ns) {
    while (!done(source) && clock_now_ns() < until_ns) {
        handle_events(source, until_ns);
        for (int i = 0; i < USB_PADS_MAX; i++)
            if (source->pads[i].state == USB_CLOSING)
                serve(&source->pads[i]);
    }
}

static bool motors_are_told(const UsbSource *source) {
    for (int i = 0; i < USB_PADS_MAX; i++)
        if (source->pads[i].state == USB_READ && source->pads[i].shaking_flies)
            return false;
    return true;
}

static bool all_are_closed(const UsbSource *source) {
    for (int i = 0; i < USB_PADS_MAX; i++)
        if (source->pads[i].state != USB_NONE)
            return false;
    return true;
}

static void stop_motors(UsbSource *source) {
    handle_events_until(source, motors_are_told, clock_now_ns() + CLOSE_NS / 5);
    for (int i = 0; i < USB_PADS_MAX; i++) {
        UsbPad *pad = &source->pads[i];
        pad->rumble_end_ns = 0;
        if (pad->state == USB_READ && !pad->gone)
            shake(pad);
    }
    handle_events_until(source, motors_are_told, clock_now_ns() + CLOSE_NS / 5);
}

static void close_all(UsbSource *source) {
    stop_motors(source);
    for (int i = 0; i < USB_PADS_MAX; i++) {
        UsbPad *pad = &source->pads[i];
        pad->gone = true;
        if (pad->state != USB_NONE)
            serve(pad);
    }
    handle_events_until(source, all_are_closed, clock_now_ns() + CLOSE_NS);
    for (int i = 0; i < USB_PADS_MAX; i++)
        if (source->pads[i].state != USB_NONE) // libusb_close forgets what did not end
            finish_close(&source->pads[i]);
}

static void *talk(void *argument) {
    UsbSource *source = argument;
    source->tells_changes = ask_for_changes(source);
    while (!atomic_load(&source->stop)) {
        if (source->tells_changes)
            take_arrivals(source);
        else
            look_at_all(source);
        for (int i = 0; i < USB_PADS_MAX; i++)
            if (source->pads[i].state != USB_NONE)
                serve(&source->pads[i]);
        atomic_store(&source->looked, true);
        handle_events(source, next_deadline_ns(source, clock_now_ns()));
    }
    if (source->tells_changes)
        libusb_hotplug_deregister_callback(source->context, source->callback);
    take_arrivals(source);
    close_all(source);
    return NULL;
}

Result usb_source_create(DeviceQueue *queue, UsbSource **out) {
    UsbSource *source = calloc(1, sizeof *source);
    if (!source) {
        log_error("devices: no memory for %zu bytes", sizeof *source);
        return RESULT_MEMORY;
    }
    Result result = RESULT_DEVICE;
    source->queue = queue;
    for (int i = 0; i < USB_PADS_MAX; i++)
        source->pads[i].slot = -1;
    int error = libusb_init(&source->context);
    if (error != 0) {
        log_debug("devices: no gamepads over USB: libusb says '%s'", libusb_strerror(error));
        goto fail;
    }
    pthread_mutex_init(&source->mutex, NULL);
    if (pthread_create(&source->thread, NULL, talk, source) != 0) {
        log_error("devices: no thread to read USB with");
        goto fail_context;
    }
    *out = source;
    return RESULT_OK;
fail_context:
    pthread_mutex_destroy(&source->mutex);
    libusb_exit(source->context);
fail:
    free(source);
    return result;
}

void usb_source_destroy(UsbSource **source) {
    if (!*source)
        return;
    atomic_store(&(*source)->stop, true);
    libusb_interrupt_event_handler((*source)->context);
    pthread_join((*source)->thread, NULL);
    libusb_exit((*source)->context);
    pthread_mutex_destroy(&(*source)->mutex);
    free(*source);
    *source = NULL;
}

bool usb_source_looked(const UsbSource *source) {
    return atomic_load(&source->looked);
}

void usb_source_rumble(UsbSource *source, int slot, double low, double high, double seconds) {
    if (slot < 0 || slot >= DEVICES_MAX || !(seconds >= 0.0))
        return;
    double bounded_s = seconds < RUMBLE_S_MAX ? seconds : RUMBLE_S_MAX;
    pthread_mutex_lock(&source->mutex);
    source->asked[slot] = (Rumble){true, low, high, clock_now_ns() + (int64_t)(bounded_s * 1e9)};
    pthread_mutex_unlock(&source->mutex);
    libusb_interrupt_event_handler(source->context);
}
