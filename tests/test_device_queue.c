// The queue between the threads that read devices and the one that flies: bounded, in order, and nobody's coming or
// going is lost on who takes from it.
#include "input/devices/device_queue.h"

#include "base/clock.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static int set_up(void **state) {
    DeviceQueue *queue;
    Result result = device_queue_create(NULL, &queue);
    *state = queue;
    return result == RESULT_OK ? 0 : -1;
}

static int tear_down(void **state) {
    DeviceQueue *queue = *state;
    device_queue_destroy(&queue);
    return 0;
}

static PadInfo info_of(uint16_t product) {
    return (PadInfo){.vendor = 0x1234, .product = product};
}

static int join(DeviceQueue *queue, uint16_t product) {
    PadInfo info = info_of(product);
    return device_queue_join(queue, &info, 0);
}

// Its first axis tells which one it is.
static void report(DeviceQueue *queue, int slot, int number) {
    PadState pad = pad_at_rest();
    pad.axes[0] = number;
    device_queue_report(queue, slot, number, &pad);
}

static int take_all(DeviceQueue *queue, DeviceEvent out[DEVICE_QUEUE_EVENTS + 1]) {
    return device_queue_take(queue, out, DEVICE_QUEUE_EVENTS + 1);
}

static void test_events_come_out_in_order(void **state) {
    DeviceQueue *queue = *state;
    static DeviceEvent events[DEVICE_QUEUE_EVENTS + 1];
    assert_int_equal(join(queue, 1), 0);
    report(queue, 0, 1);
    assert_int_equal(join(queue, 2), 1);
    report(queue, 1, 2);
    report(queue, 0, 3);
    assert_int_equal(device_queue_take(queue, events, 2), 2);
    assert_int_equal(device_queue_take(queue, events + 2, 99), 3);
    static const DeviceEventKind kinds[] = {DEVICE_ARRIVED, DEVICE_REPORT, DEVICE_ARRIVED, DEVICE_REPORT,
                                            DEVICE_REPORT};
    static const int slots[] = {0, 0, 1, 1, 0};
    for (int i = 0; i < 5; i++) {
        print_message("%d: kind %d of slot %d, expected %d of %d\n", i, events[i].kind, events[i].slot, kinds[i],
                      slots[i]);
        assert_true(events[i].kind == kinds[i] && events[i].slot == slots[i]);
    }
    assert_int_equal(events[2].info.product, 2);
    assert_true(events[4].state.axes[0] == 3.0 && events[4].time_ns == 3);
    assert_int_equal(take_all(queue, events), 0);
}

static void test_a_full_queue_loses_the_oldest_report_of_the_same_device(void **state) {
    DeviceQueue *queue = *state;
    static DeviceEvent events[DEVICE_QUEUE_EVENTS + 1];
    join(queue, 1);
    join(queue, 2);
    report(queue, 1, -1);
    for (int i = 0; i < 1000; i++)
        report(queue, 0, i);
    int count = take_all(queue, events);
    print_message("%d events wait of 1003, %lld were lost\n", count, (long long)device_queue_lost(queue));
    assert_int_equal(count, DEVICE_QUEUE_EVENTS);
    assert_int_equal(device_queue_lost(queue), 1003 - DEVICE_QUEUE_EVENTS);
    assert_true(events[0].kind == DEVICE_ARRIVED && events[1].kind == DEVICE_ARRIVED);
    assert_true(events[2].slot == 1 && events[2].state.axes[0] == -1.0);
    for (int i = 3; i < count; i++)
        assert_true(events[i].state.axes[0] == 1000.0 - count + i);
}

static void test_a_device_without_reports_in_a_full_queue_loses_those_of_others(void **state) {
    DeviceQueue *queue = *state;
    static DeviceEvent events[DEVICE_QUEUE_EVENTS + 1];
    join(queue, 1);
    for (int i = 0; i < DEVICE_QUEUE_EVENTS; i++)
        report(queue, 0, i);
    int slot = join(queue, 2);
    report(queue, slot, 5000);
    int count = take_all(queue, events);
    assert_int_equal(count, DEVICE_QUEUE_EVENTS);
    assert_true(events[count - 2].kind == DEVICE_ARRIVED && events[count - 2].slot == slot);
    assert_true(events[count - 1].state.axes[0] == 5000.0);
}

static void test_who_comes_and_goes_unseen_is_never_told(void **state) {
    DeviceQueue *queue = *state;
    static DeviceEvent events[DEVICE_QUEUE_EVENTS + 1];
    for (int i = 0; i < 1000; i++) {
        assert_int_equal(join(queue, (uint16_t)i), 0);
        report(queue, 0, i);
        device_queue_leave(queue, 0);
    }
    assert_int_equal(take_all(queue, events), 0);
    join(queue, 7);
    assert_int_equal(take_all(queue, events), 1);
    for (int i = 0; i < 1000; i++) { // the one that is known goes, others take its slot
        device_queue_leave(queue, 0);
        assert_int_equal(join(queue, (uint16_t)i), 0);
    }
    int count = take_all(queue, events);
    print_message("%d events after 1000 changes of the device in a slot, expected LEFT and ARRIVED\n", count);
    assert_int_equal(count, 2);
    assert_true(events[0].kind == DEVICE_LEFT && events[1].kind == DEVICE_ARRIVED && events[1].info.product == 999);
}

typedef struct Hooked {
    DeviceQueue *queue;
    int made[DEVICES_MAX]; // product of the latest by slot
    int calls, told;       // how often; events that could be taken at a call
} Hooked;

static void make(void *user, int slot, const PadInfo *info) {
    Hooked *hooked = user;
    DeviceEvent event;
    hooked->made[slot] = info->product;
    hooked->calls++;
    hooked->told += device_queue_take(hooked->queue, &event, 1);
}

static void test_the_hook_comes_before_the_arrival(void **state) {
    (void)state;
    Hooked hooked = {.calls = 0};
    DeviceHook hook = {make, &hooked};
    static DeviceEvent events[DEVICE_QUEUE_EVENTS + 1];
    PadInfo denied = info_of(9);
    assert_int_equal(device_queue_create(&hook, &hooked.queue), RESULT_OK);
    assert_int_equal(join(hooked.queue, 7), 0);
    assert_true(hooked.calls == 1 && hooked.told == 0 && hooked.made[0] == 7);
    assert_int_equal(device_queue_join(hooked.queue, &denied, 13), 1);
    assert_int_equal(hooked.calls, 1); // nothing can be read of it yet
    assert_int_equal(take_all(hooked.queue, events), 2);
    device_queue_change(hooked.queue, 1, &denied, 0);
    assert_true(hooked.calls == 2 && hooked.told == 0 && hooked.made[1] == 9);
    assert_int_equal(take_all(hooked.queue, events), 1);
    device_queue_destroy(&hooked.queue);
}

static void test_who_is_denied_may_be_read_later(void **state) {
    DeviceQueue *queue = *state;
    static DeviceEvent events[DEVICE_QUEUE_EVENTS + 1];
    PadInfo info = info_of(9);
    int slot = device_queue_join(queue, &info, 13);
    assert_int_equal(take_all(queue, events), 1);
    assert_true(events[0].kind == DEVICE_DENIED && events[0].error == 13 && events[0].info.product == 9);
    device_queue_change(queue, slot, &info, 16);
    device_queue_change(queue, slot, &info, 0);
    assert_int_equal(take_all(queue, events), 1);
    assert_true(events[0].kind == DEVICE_ARRIVED && events[0].slot == slot);
    device_queue_change(queue, slot, &info, 13); // it waits when the device goes, of which the taker knows
    device_queue_leave(queue, slot);
    assert_int_equal(take_all(queue, events), 1);
    assert_true(events[0].kind == DEVICE_LEFT);
}

static void test_there_are_so_many_slots_and_no_more(void **state) {
    DeviceQueue *queue = *state;
    for (int i = 0; i < DEVICES_MAX; i++)
        assert_int_equal(join(queue, (uint16_t)i), i);
    assert_int_equal(join(queue, 99), -1);
    device_queue_leave(queue, 5);
    assert_int_equal(join(queue, 99), 5);
}

typedef struct Producer {
    DeviceQueue *queue;
    pthread_t thread;
    atomic_bool done;
} Producer;

#define PRODUCERS 4
#define LIVES 50
#define REPORTS 100

static void *produce(void *argument) {
    Producer *producer = argument;
    for (int life = 0; life < LIVES; life++) {
        int slot = join(producer->queue, (uint16_t)life);
        for (int i = 0; i < REPORTS; i++) {
            report(producer->queue, slot, i);
            if (i % 4 == 0) // no device says so much that nobody else gets the mutex
                clock_sleep_until_ns(clock_now_ns() + 10000);
        }
        device_queue_leave(producer->queue, slot);
    }
    atomic_store(&producer->done, true);
    return NULL;
}

// Checks what the taker may rely on; `there` is who it knows, `last` their last report.
static void check(const DeviceEvent *event, bool there[DEVICES_MAX], double last[DEVICES_MAX]) {
    bool *known = &there[event->slot];
    if (event->kind == DEVICE_REPORT) {
        assert_true(*known && event->state.axes[0] > last[event->slot]);
        last[event->slot] = event->state.axes[0];
    } else {
        assert_true(*known == (event->kind == DEVICE_LEFT));
        *known = event->kind == DEVICE_ARRIVED;
        last[event->slot] = -1.0;
    }
}

static bool all_done(Producer *producers) {
    for (int i = 0; i < PRODUCERS; i++)
        if (!atomic_load(&producers[i].done))
            return false;
    return true;
}

static void test_many_threads_put_and_one_takes(void **state) {
    DeviceQueue *queue = *state;
    Producer producers[PRODUCERS];
    bool there[DEVICES_MAX] = {false};
    double last[DEVICES_MAX] = {0.0};
    DeviceEvent events[16];
    int taken = 0, count = 0;
    for (int i = 0; i < PRODUCERS; i++) {
        producers[i].queue = queue;
        atomic_store(&producers[i].done, false);
        assert_int_equal(pthread_create(&producers[i].thread, NULL, produce, &producers[i]), 0);
    }
    for (bool done = false; !done || count > 0; taken += count) {
        done = all_done(producers);
        count = device_queue_take(queue, events, (int)COUNT_OF(events));
        for (int i = 0; i < count; i++)
            check(&events[i], there, last);
    }
    for (int i = 0; i < PRODUCERS; i++)
        pthread_join(producers[i].thread, NULL);
    for (int i = 0; i < DEVICES_MAX; i++)
        assert_false(there[i]);
    assert_true(taken > PRODUCERS * LIVES);
    print_message("%d events taken of %d reports, %lld reports pushed out\n", taken, PRODUCERS * LIVES * REPORTS,
                  (long long)device_queue_lost(queue));
}

#define QUEUE_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void) {
    const struct CMUnitTest tests[] = {
        QUEUE_TEST(test_events_come_out_in_order),
        QUEUE_TEST(test_a_full_queue_loses_the_oldest_report_of_the_same_device),
        QUEUE_TEST(test_a_device_without_reports_in_a_full_queue_loses_those_of_others),
        QUEUE_TEST(test_who_comes_and_goes_unseen_is_never_told),
        cmocka_unit_test(test_the_hook_comes_before_the_arrival),
        QUEUE_TEST(test_who_is_denied_may_be_read_later),
        QUEUE_TEST(test_there_are_so_many_slots_and_no_more),
        QUEUE_TEST(test_many_threads_put_and_one_takes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
