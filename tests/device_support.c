#define _POSIX_C_SOURCE 200809L
#include "tests/device_support.h"

#include "base/clock.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>
#include <linux/hidraw.h>
#include <linux/usbdevice_fs.h>
#include <umockdev.h>

#define STICKS_MAX 24
#define PADS_MAX 16
#define FLYING_MAX 8
#define REPORTS_MAX 256
#define BUS "/devices/pci0000:00/0000:00:14.0/usb1"

struct FakeStick {
    UMockdevTestbed *testbed;
    UMockdevIoctlBase *handler;
    int number, fd;
    uint16_t vendor, product;
    int descriptor_bytes;
};

typedef struct FakeReport {
    uint8_t bytes[64];
    int count;
} FakeReport;

struct FakePad {
    UMockdevTestbed *testbed;
    UMockdevIoctlBase *handler;
    int address;
    pthread_mutex_t mutex; // over what follows: umockdev answers on a thread of its own
    bool is_gone;
    FakeHolder holder;
    UMockdevIoctlData *flying[FLYING_MAX], *done[FLYING_MAX]; // URBs
    int flying_count, done_count;
    FakeReport reports[REPORTS_MAX];
    int report_count;
    uint8_t rumbles[FAKE_RUMBLES_MAX][8];
    int rumble_count;
};

// Devices stay until the end: a library may still close one that was unplugged.
struct FakeBed {
    UMockdevTestbed *testbed;
    FakeStick *sticks[STICKS_MAX];
    FakePad *pads[PADS_MAX];
    int stick_count, pad_count;
};

bool fake_bed_works(void) {
    UMockdevTestbed *testbed = umockdev_testbed_new(); // before there is one, nothing is told
    bool works = umockdev_in_mock_environment();
    g_object_unref(testbed);
    if (!works)
        print_message("skipped: umockdev's preload library is not there\n");
    return works;
}

FakeBed *fake_bed_create(void) {
    FakeBed *bed = calloc(1, sizeof *bed);
    bed->testbed = umockdev_testbed_new();
    // There before anybody watches it, as it is on a real system.
    gchar *root = umockdev_testbed_get_root_dir(bed->testbed);
    gchar *folder = g_build_filename(root, "dev", NULL);
    assert_int_equal(g_mkdir_with_parents(folder, 0755), 0);
    g_free(folder);
    g_free(root);
    return bed;
}

void fake_bed_open_to_all(FakeBed *bed) {
    gchar *root = umockdev_testbed_get_root_dir(bed->testbed);
    assert_int_equal(chmod(root, 0755), 0);
    g_free(root);
}

static void announce_removal(UMockdevTestbed *testbed, const char *device) {
    gchar *path = g_strconcat("/sys", device, NULL);
    umockdev_testbed_uevent(testbed, path, "remove");
    umockdev_testbed_remove_device(testbed, path);
    g_free(path);
}

static void add(UMockdevTestbed *testbed, gchar *blocks) {
    GError *error = NULL;
    if (!umockdev_testbed_add_from_string(testbed, blocks, &error))
        fail_msg("umockdev: %s", error->message);
    g_free(blocks);
}

static void attach(UMockdevTestbed *testbed, const char *node, UMockdevIoctlBase *handler) {
    GError *error = NULL;
    if (!umockdev_testbed_attach_ioctl(testbed, node, handler, &error))
        fail_msg("umockdev: %s: %s", node, error->message);
}

static void detach(UMockdevTestbed *testbed, const char *node) {
    GError *error = NULL;
    if (!umockdev_testbed_detach_ioctl(testbed, node, &error))
        fail_msg("umockdev: %s: %s", node, error->message);
}

// Where the caller's argument points.
static UMockdevIoctlData *argument(UMockdevIoctlClient *client, size_t bytes) {
    return umockdev_ioctl_data_resolve(umockdev_ioctl_client_get_arg(client), 0, bytes, NULL);
}

static gboolean answer(UMockdevIoctlClient *client, int error) {
    umockdev_ioctl_client_complete(client, error ? -1 : 0, error);
    return TRUE;
}

// ---- HID ----------------------------------------------------------------------------------------------------------

static const uint8_t joystick_descriptor[] = {
    0x05, 0x01, 0x09, 0x04, 0xa1, 0x01, 0x09, 0x30, 0x09, 0x31, 0x09, 0x35, 0x15, 0x00, 0x27, 0xff, 0xff,
    0x00, 0x00, 0x75, 0x10, 0x95, 0x03, 0x81, 0x02, 0x09, 0x36, 0x26, 0xff, 0x00, 0x75, 0x08, 0x95, 0x01,
    0x81, 0x02, 0x09, 0x39, 0x25, 0x07, 0x35, 0x00, 0x46, 0x3b, 0x01, 0x75, 0x04, 0x81, 0x42, 0x75, 0x04,
    0x81, 0x03, 0x05, 0x09, 0x19, 0x01, 0x29, 0x08, 0x25, 0x01, 0x75, 0x01, 0x95, 0x08, 0x81, 0x02, 0xc0};
// A boot mouse: HID 1.11, appendix E.10.
static const uint8_t mouse_descriptor[] = {0x05, 0x01, 0x09, 0x02, 0xa1, 0x01, 0x09, 0x01, 0xa1, 0x00, 0x05, 0x09, 0x19,
                                           0x01, 0x29, 0x03, 0x15, 0x00, 0x25, 0x01, 0x95, 0x03, 0x75, 0x01, 0x81, 0x02,
                                           0x95, 0x01, 0x75, 0x05, 0x81, 0x01, 0x05, 0x01, 0x09, 0x30, 0x09, 0x31, 0x15,
                                           0x81, 0x25, 0x7f, 0x75, 0x08, 0x95, 0x02, 0x81, 0x06, 0xc0, 0xc0};

const FakeStickModel FAKE_JOYSTICK = {0x044f, 0xb10a, "Pretended Stick", joystick_descriptor,
                                      sizeof joystick_descriptor};
const FakeStickModel FAKE_MOUSE = {0x046d, 0xc077, "Pretended Mouse", mouse_descriptor, sizeof mouse_descriptor};

void fake_joystick_report(double x, double y, double rz, double slider, int hat, uint8_t buttons,
                          uint8_t out[FAKE_STICK_BYTES]) {
    double axes[3] = {x, y, rz};
    for (int i = 0; i < 3; i++) {
        long value = lround((axes[i] + 1.0) * 0.5 * 65535.0);
        out[2 * i] = (uint8_t)(value & 0xff);
        out[2 * i + 1] = (uint8_t)(value >> 8);
    }
    out[6] = (uint8_t)lround((slider + 1.0) * 0.5 * 255.0);
    out[7] = hat < 0 ? 0x0f : (uint8_t)hat;
    out[8] = buttons;
}

static gboolean on_hid_ioctl(UMockdevIoctlBase *handler, UMockdevIoctlClient *client, void *user) {
    (void)handler;
    const FakeStick *stick = user;
    if (umockdev_ioctl_client_get_request(client) != HIDIOCGRDESCSIZE)
        return answer(client, ENOTTY);
    UMockdevIoctlData *size = argument(client, sizeof(int));
    memcpy(size->data, &stick->descriptor_bytes, sizeof(int));
    g_object_unref(size);
    return answer(client, 0);
}

static gchar *hex_of(const uint8_t *bytes, size_t count) {
    gchar *hex = g_malloc0(2 * count + 1);
    for (size_t i = 0; i < count; i++)
        snprintf(hex + 2 * i, 3, "%02X", bytes[i]);
    return hex;
}

// The node, its HID device, the interface, the USB device: as /sys has them, each inside of the next.
static void stick_paths(const FakeStick *stick, gchar *paths[4]) {
    int port = stick->number + 10;
    paths[3] = g_strdup_printf(BUS "/1-%d", port);
    paths[2] = g_strdup_printf("%s/1-%d:1.0", paths[3], port);
    paths[1] = g_strdup_printf("%s/0003:%04X:%04X.%04X", paths[2], stick->vendor, stick->product, stick->number + 1);
    paths[0] = g_strdup_printf("%s/hidraw/hidraw%d", paths[1], stick->number);
}

// What holds the others comes first, as in a kernel: the node is announced when all of it is there.
static gchar *stick_blocks(const FakeStick *stick, const FakeStickModel *model, gchar *const paths[4]) {
    gchar *hex = hex_of(model->descriptor, model->descriptor_bytes);
    gchar *blocks = g_strdup_printf(
        "P: %s\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nA: idVendor=%04x\\n\nA: idProduct=%04x\\n\n"
        "A: manufacturer=Nobody\\n\nA: product=%s\\n\nA: bcdDevice=0100\\n\n\n"
        "P: %s\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_interface\nA: bInterfaceNumber=00\\n\n\n"
        "P: %s\nE: SUBSYSTEM=hid\nE: DRIVER=hid-generic\nE: HID_ID=0003:%08X:%08X\nE: HID_NAME=%s\nE: HID_UNIQ=\n"
        "H: report_descriptor=%s\n\n"
        "P: %s\nN: hidraw%d\nE: DEVNAME=/dev/hidraw%d\nE: SUBSYSTEM=hidraw\nE: MAJOR=241\nE: MINOR=%d\n"
        "L: device=../../../%s\n",
        paths[3], model->vendor, model->product, model->name, paths[2], paths[1], model->vendor, model->product,
        model->name, hex, paths[0], stick->number, stick->number, stick->number, strrchr(paths[1], '/') + 1);
    g_free(hex);
    return blocks;
}

static void free_paths(gchar *paths[4]) {
    for (int i = 0; i < 4; i++)
        g_free(paths[i]);
}

FakeStick *fake_stick_plug(FakeBed *bed, const FakeStickModel *model, int number) {
    gchar *paths[4], node[32];
    FakeStick *stick = calloc(1, sizeof *stick);
    assert_true(bed->stick_count < STICKS_MAX);
    bed->sticks[bed->stick_count++] = stick;
    *stick = (FakeStick){bed->testbed,   umockdev_ioctl_base_new(),   number, -1, model->vendor,
                         model->product, (int)model->descriptor_bytes};
    snprintf(node, sizeof node, "/dev/hidraw%d", number);
    g_signal_connect(stick->handler, "handle-ioctl", G_CALLBACK(on_hid_ioctl), stick);
    attach(stick->testbed, node, stick->handler);
    stick_paths(stick, paths);
    add(stick->testbed, stick_blocks(stick, model, paths));
    stick->fd = umockdev_testbed_get_dev_fd(stick->testbed, node);
    free_paths(paths);
    return stick;
}

void fake_stick_send(FakeStick *stick, const uint8_t *bytes, size_t count) {
    assert_int_equal(write(stick->fd, bytes, count), count);
}

// umockdev leaves the node behind, which the kernel takes away.
static void remove_node(FakeStick *stick, const char *node) {
    gchar *root = umockdev_testbed_get_root_dir(stick->testbed);
    gchar *file = g_strconcat(root, node, NULL);
    assert_int_equal(unlink(file), 0);
    g_free(file);
    g_free(root);
}

void fake_stick_unplug(FakeStick *stick) {
    gchar *paths[4], node[32];
    if (stick->fd < 0)
        return;
    snprintf(node, sizeof node, "/dev/hidraw%d", stick->number);
    close(stick->fd);
    stick->fd = -1;
    stick_paths(stick, paths);
    for (int i = 0; i < 4; i++)
        announce_removal(stick->testbed, paths[i]);
    remove_node(stick, node);
    detach(stick->testbed, node);
    free_paths(paths);
}

// ---- USB ----------------------------------------------------------------------------------------------------------

// A wired Xbox 360 pad: its interface of pads, and the one of headsets, each with two interrupt endpoints.
static const uint8_t pad_descriptors[] = {
    0x12, 0x01, 0x00, 0x02, 0xff, 0xff, 0xff, 0x08, 0x5e, 0x04, 0x8e, 0x02, 0x14, 0x01, 0x01, 0x02, 0x03, 0x01, //
    0x09, 0x02, 0x37, 0x00, 0x02, 0x01, 0x00, 0xa0, 0xfa,                                                       //
    0x09, 0x04, 0x00, 0x00, 0x02, 0xff, 0x5d, 0x01, 0x00,                                                       //
    0x07, 0x05, 0x81, 0x03, 0x20, 0x00, 0x04, 0x07, 0x05, 0x01, 0x03, 0x20, 0x00, 0x08,                         //
    0x09, 0x04, 0x01, 0x00, 0x02, 0xff, 0x5d, 0x03, 0x00,                                                       //
    0x07, 0x05, 0x82, 0x03, 0x20, 0x00, 0x02, 0x07, 0x05, 0x02, 0x03, 0x20, 0x00, 0x04};

static void land(FakePad *pad, int index, int status, int bytes) {
    UMockdevIoctlData *data = pad->flying[index];
    struct usbdevfs_urb *urb = (struct usbdevfs_urb *)(void *)data->data;
    urb->status = status;
    urb->actual_length = bytes;
    pad->flying_count--;
    memmove(&pad->flying[index], &pad->flying[index + 1], (size_t)(pad->flying_count - index) * sizeof data);
    pad->done[pad->done_count++] = data;
}

static int submit(FakePad *pad, UMockdevIoctlClient *client) {
    UMockdevIoctlData *data = argument(client, sizeof(struct usbdevfs_urb));
    const struct usbdevfs_urb *urb = (const void *)data->data;
    UMockdevIoctlData *buffer =
        umockdev_ioctl_data_resolve(data, offsetof(struct usbdevfs_urb, buffer), (gsize)urb->buffer_length, NULL);
    bool is_rumble = urb->endpoint == 0x01 && urb->buffer_length == 8;
    if (urb->type != USBDEVFS_URB_TYPE_INTERRUPT || pad->flying_count + pad->done_count == FLYING_MAX ||
        (urb->endpoint != 0x81 && !is_rumble)) {
        g_object_unref(buffer);
        g_object_unref(data);
        return EINVAL;
    }
    pad->flying[pad->flying_count++] = data;
    if (is_rumble && pad->rumble_count < FAKE_RUMBLES_MAX)
        memcpy(pad->rumbles[pad->rumble_count++], buffer->data, 8);
    if (is_rumble)
        land(pad, pad->flying_count - 1, 0, 8);
    g_object_unref(buffer);
    return 0;
}

static void land_report(FakePad *pad) {
    const struct usbdevfs_urb *urb = (const void *)pad->flying[0]->data;
    UMockdevIoctlData *buffer = umockdev_ioctl_data_resolve(pad->flying[0], offsetof(struct usbdevfs_urb, buffer),
                                                            (gsize)urb->buffer_length, NULL);
    memcpy(buffer->data, pad->reports[0].bytes, (size_t)pad->reports[0].count);
    g_object_unref(buffer);
    land(pad, 0, 0, pad->reports[0].count);
    pad->report_count--;
    memmove(&pad->reports[0], &pad->reports[1], (size_t)pad->report_count * sizeof pad->reports[0]);
}

static int reap(FakePad *pad, UMockdevIoctlClient *client) {
    if (pad->done_count == 0 && pad->flying_count > 0 && pad->is_gone)
        land(pad, 0, -ENODEV, 0);
    else if (pad->done_count == 0 && pad->flying_count > 0 && pad->report_count > 0)
        land_report(pad);
    if (pad->done_count == 0)
        return pad->is_gone ? ENODEV : EAGAIN;
    UMockdevIoctlData *where = argument(client, sizeof(void *));
    umockdev_ioctl_data_set_ptr(where, 0, pad->done[0]);
    g_object_unref(where);
    g_object_unref(pad->done[0]);
    pad->done_count--;
    memmove(&pad->done[0], &pad->done[1], (size_t)pad->done_count * sizeof pad->done[0]);
    return 0;
}

static int discard(FakePad *pad, UMockdevIoctlClient *client) {
    gulong address;
    memcpy(&address, umockdev_ioctl_client_get_arg(client)->data, sizeof address);
    for (int i = 0; i < pad->flying_count; i++)
        if (pad->flying[i]->client_addr == address) {
            land(pad, i, -ENOENT, 0);
            return 0;
        }
    return EINVAL;
}

static int tell_driver(const FakePad *pad, UMockdevIoctlClient *client) {
    if (pad->holder != FAKE_KERNEL)
        return ENODATA;
    UMockdevIoctlData *data = argument(client, sizeof(struct usbdevfs_getdriver));
    struct usbdevfs_getdriver *driver = (void *)data->data;
    snprintf(driver->driver, sizeof driver->driver, "xpad");
    g_object_unref(data);
    return 0;
}

static int tell_capabilities(UMockdevIoctlClient *client) {
    UMockdevIoctlData *data = argument(client, sizeof(uint32_t));
    uint32_t capabilities = USBDEVFS_CAP_NO_PACKET_SIZE_LIM | USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
    memcpy(data->data, &capabilities, sizeof capabilities);
    g_object_unref(data);
    return 0;
}

static int serve(FakePad *pad, UMockdevIoctlClient *client) {
    unsigned long request = umockdev_ioctl_client_get_request(client);
    if (request == USBDEVFS_REAPURBNDELAY || request == USBDEVFS_REAPURB)
        return reap(pad, client);
    if (pad->is_gone)
        return ENODEV;
    switch (request) {
    case USBDEVFS_GET_CAPABILITIES:
        return tell_capabilities(client);
    case USBDEVFS_SUBMITURB:
        return submit(pad, client);
    case USBDEVFS_DISCARDURB:
        return discard(pad, client);
    case USBDEVFS_GETDRIVER:
        return tell_driver(pad, client);
    case USBDEVFS_DISCONNECT_CLAIM:
        if (pad->holder == FAKE_HELD)
            return EBUSY;
        pad->holder = FAKE_FREE;
        return 0;
    case USBDEVFS_IOCTL: // libusb sends it to give the interface back
        pad->holder = FAKE_KERNEL;
        return 0;
    case USBDEVFS_CLAIMINTERFACE:
        return pad->holder != FAKE_FREE ? EBUSY : 0;
    case USBDEVFS_RELEASEINTERFACE:
        return 0;
    default:
        return ENOTTY;
    }
}

static gboolean on_usb_ioctl(UMockdevIoctlBase *handler, UMockdevIoctlClient *client, void *user) {
    (void)handler;
    FakePad *pad = user;
    pthread_mutex_lock(&pad->mutex);
    int error = serve(pad, client);
    pthread_mutex_unlock(&pad->mutex);
    if (error == EAGAIN) // libusb, told by a file that it is ready, would ask at full speed
        clock_sleep_until_ns(clock_now_ns() + 1000000);
    return answer(client, error);
}

static gchar *pad_path(const FakePad *pad) {
    return g_strdup_printf(BUS "/1-%d", pad->address);
}

static void plug_pad(FakePad *pad, const char *node) {
    gchar *path = pad_path(pad), *hex = hex_of(pad_descriptors, sizeof pad_descriptors);
    attach(pad->testbed, node, pad->handler);
    add(pad->testbed,
        g_strdup_printf("P: %s\nN: %s=%s\nE: DEVNAME=%s\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nE: BUSNUM=001\n"
                        "E: DEVNUM=%03d\nA: busnum=1\\n\nA: devnum=%d\\n\nA: speed=12\\n\nA: bConfigurationValue=1\\n\n"
                        "A: idVendor=045e\\n\nA: idProduct=028e\\n\nA: manufacturer=Nobody\\n\n"
                        "A: product=Pretended Pad\\n\nH: descriptors=%s\n",
                        path, node + strlen("/dev/"), hex, node, pad->address, pad->address, hex));
    g_free(hex);
    g_free(path);
}

FakePad *fake_pad_plug(FakeBed *bed, int address, FakeHolder holder) {
    char node[32];
    FakePad *pad = calloc(1, sizeof *pad);
    assert_true(bed->pad_count < PADS_MAX);
    bed->pads[bed->pad_count++] = pad;
    *pad = (FakePad){.testbed = bed->testbed, .handler = umockdev_ioctl_base_new(), .address = address};
    pad->holder = holder;
    pthread_mutex_init(&pad->mutex, NULL);
    g_signal_connect(pad->handler, "handle-ioctl", G_CALLBACK(on_usb_ioctl), pad);
    snprintf(node, sizeof node, "/dev/bus/usb/001/%03d", address);
    plug_pad(pad, node);
    return pad;
}

// False: so many wait that nobody asked for that there is no place for another.
static bool put_report(FakePad *pad, const uint8_t *bytes, size_t count) {
    pthread_mutex_lock(&pad->mutex);
    bool has_place = pad->report_count < REPORTS_MAX;
    if (has_place) {
        FakeReport *report = &pad->reports[pad->report_count++];
        report->count = (int)count;
        memcpy(report->bytes, bytes, count);
    }
    pthread_mutex_unlock(&pad->mutex);
    return has_place;
}

void fake_pad_send(FakePad *pad, const uint8_t *bytes, size_t count) {
    int64_t until_ns = clock_now_ns() + 10 * INT64_C(1000000000);
    bool sent = false;
    assert_true(count <= sizeof pad->reports[0].bytes);
    while (!(sent = put_report(pad, bytes, count)) && clock_now_ns() < until_ns)
        clock_sleep_until_ns(clock_now_ns() + 1000000);
    assert_true(sent);
}

void fake_pad_unplug(FakePad *pad) {
    pthread_mutex_lock(&pad->mutex);
    bool was_gone = pad->is_gone;
    pad->is_gone = true;
    pthread_mutex_unlock(&pad->mutex);
    gchar *path = pad_path(pad);
    if (!was_gone)
        announce_removal(pad->testbed, path);
    g_free(path);
}

static void free_pad(FakePad *pad) {
    for (int i = 0; i < pad->flying_count; i++)
        g_object_unref(pad->flying[i]);
    for (int i = 0; i < pad->done_count; i++)
        g_object_unref(pad->done[i]);
    g_object_unref(pad->handler);
    pthread_mutex_destroy(&pad->mutex);
    free(pad);
}

int fake_pad_rumbles(FakePad *pad, uint8_t out[FAKE_RUMBLES_MAX][8]) {
    pthread_mutex_lock(&pad->mutex);
    int count = pad->rumble_count;
    memcpy(out, pad->rumbles, (size_t)count * 8);
    pthread_mutex_unlock(&pad->mutex);
    return count;
}

void fake_pad_let_go(FakePad *pad) {
    pthread_mutex_lock(&pad->mutex);
    pad->holder = FAKE_FREE;
    pthread_mutex_unlock(&pad->mutex);
}

bool fake_pad_is_with_kernel(FakePad *pad) {
    pthread_mutex_lock(&pad->mutex);
    bool is_with_kernel = pad->holder == FAKE_KERNEL;
    pthread_mutex_unlock(&pad->mutex);
    return is_with_kernel;
}

static void put_stick(double share, uint8_t out[2]) {
    long value = lround(share * 32767.0);
    out[0] = (uint8_t)(value & 0xff);
    out[1] = (uint8_t)(value >> 8 & 0xff);
}

void fake_pad_report(const FakePadHands *hands, uint8_t out[FAKE_PAD_BYTES]) {
    memset(out, 0, FAKE_PAD_BYTES);
    out[1] = FAKE_PAD_BYTES;
    out[2] = (uint8_t)(hands->buttons & 0xff);
    out[3] = (uint8_t)(hands->buttons >> 8);
    out[4] = (uint8_t)lround(hands->left_trigger * 255.0);
    out[5] = (uint8_t)lround(hands->right_trigger * 255.0);
    put_stick(hands->left_x, out + 6);
    put_stick(hands->left_y, out + 8);
    put_stick(hands->right_x, out + 10);
    put_stick(hands->right_y, out + 12);
}

// ---- All ----------------------------------------------------------------------------------------------------------

// Devices are freed when umockdev's thread, which answers for them, has ended.
void fake_bed_destroy(FakeBed **bed) {
    for (int i = 0; i < (*bed)->stick_count; i++)
        fake_stick_unplug((*bed)->sticks[i]);
    for (int i = 0; i < (*bed)->pad_count; i++)
        fake_pad_unplug((*bed)->pads[i]);
    g_object_unref((*bed)->testbed);
    for (int i = 0; i < (*bed)->stick_count; i++) {
        g_object_unref((*bed)->sticks[i]->handler);
        free((*bed)->sticks[i]);
    }
    for (int i = 0; i < (*bed)->pad_count; i++)
        free_pad((*bed)->pads[i]);
    free(*bed);
    *bed = NULL;
}

bool fake_wait(Devices *devices, DeviceEventKind kind, DeviceEvent *event) {
    int64_t until_ns = clock_now_ns() + 20 * INT64_C(1000000000);
    do {
        while (devices_poll(devices, event, 1) == 1)
            if (event->kind == kind)
                return true;
        clock_sleep_until_ns(clock_now_ns() + 50000);
    } while (clock_now_ns() < until_ns);
    return false;
}
