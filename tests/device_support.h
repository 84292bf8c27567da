// tests/device_support.h: sticks and gamepads that are not there, under umockdev: the real hidapi and libusb read them.
// Reports are bytes as the device would send them.
// A FakeBed is the process's only one; it owns its devices. The program must be started with umockdev's preload library
// (overfly_device_test in tests/CMakeLists.txt); its children see the same devices.
#pragma once
#include "input/devices/devices.h"

typedef struct FakeBed FakeBed;
typedef struct FakeStick FakeStick; // a HID device with a hidraw node
typedef struct FakePad FakePad;     // a wired Xbox 360 pad

#define FAKE_RUMBLES_MAX 64

// Whether the preload library is there; where not, it says that tests are skipped, for which main returns 77.
bool fake_bed_works(void);
FakeBed *fake_bed_create(void);
void fake_bed_destroy(FakeBed **bed);
// Others than its maker may look into its /sys and /dev, where nodes have their own permissions.
void fake_bed_open_to_all(FakeBed *bed);

typedef struct FakeStickModel {
    uint16_t vendor, product;
    const char *name;
    const uint8_t *descriptor;
    size_t descriptor_bytes;
} FakeStickModel;
// A joystick with X, Y, Rz (16 bit, 0..65535), a throttle (Slider, 8 bit, 0..255), a hat and 8 buttons; its reports
// have no ids and FAKE_STICK_BYTES bytes.
extern const FakeStickModel FAKE_JOYSTICK;
#define FAKE_STICK_BYTES 9
// Axes -1..1; hat in eighths, -1: centred; buttons as bits.
void fake_joystick_report(double x, double y, double rz, double slider, int hat, uint8_t buttons,
                          uint8_t out[FAKE_STICK_BYTES]);
extern const FakeStickModel FAKE_MOUSE; // which nobody should read

// As /dev/hidraw`number`, a new one each time: umockdev makes no node twice.
FakeStick *fake_stick_plug(FakeBed *bed, const FakeStickModel *model, int number);
// The node is a terminal's: two reports that nobody read in between are read as one, so leave time between them.
void fake_stick_send(FakeStick *stick, const uint8_t *bytes, size_t count);
void fake_stick_unplug(FakeStick *stick);

// Who has a pad's interface when it is plugged in.
typedef enum FakeHolder {
    FAKE_FREE,
    FAKE_KERNEL, // its driver xpad, until somebody detaches it
    FAKE_HELD,   // another program, until fake_pad_let_go: whoever wants it is told that it is busy
} FakeHolder;
// As /dev/bus/usb/001/`address`, a new one each time, as the kernel does.
FakePad *fake_pad_plug(FakeBed *bed, int address, FakeHolder holder);
void fake_pad_let_go(FakePad *pad);
void fake_pad_send(FakePad *pad, const uint8_t *bytes, size_t count);
void fake_pad_unplug(FakePad *pad);
// The messages sent to the motors so far, the first FAKE_RUMBLES_MAX; their number.
int fake_pad_rumbles(FakePad *pad, uint8_t out[FAKE_RUMBLES_MAX][8]);
bool fake_pad_is_with_kernel(FakePad *pad);

typedef struct FakePadHands {
    double left_x, left_y, right_x, right_y; // -1..1; forward and right are positive, as the pad sends them
    double left_trigger, right_trigger;      // 0..1
    uint16_t buttons;                        // byte 2 (low) and byte 3 (high) of the report
} FakePadHands;
#define FAKE_PAD_BYTES 20
void fake_pad_report(const FakePadHands *hands, uint8_t out[FAKE_PAD_BYTES]);

// Polls until an event of `kind` comes, for at most 20 s: true, and the event. Earlier events of other kinds are passed
// over.
bool fake_wait(Devices *devices, DeviceEventKind kind, DeviceEvent *event);
