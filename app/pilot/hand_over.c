#include "app/pilot/hand_over.h"

#include <math.h>

static double clamp(double value, double least, double greatest) {
    return fmin(fmax(value, least), greatest);
}

HandOver hand_over_begin(const Controls *before) {
    return (HandOver){.before = *before,
                      .begins = true,
                      .left_s = HAND_OVER_S,
                      .brakes = before->brake_left > 0.0 || before->brake_right > 0.0};
}

static void compare(HandOver *hand_over, const Controls *now) {
    const Controls *before = &hand_over->before;
    double was = clamp(before->elevator + before->trim, -1.0, 1.0), is = clamp(now->elevator + now->trim, -1.0, 1.0);
    hand_over->begins = false;
    hand_over->elevator = was - is;
    hand_over->aileron = before->aileron - now->aileron;
    hand_over->rudder = before->rudder - now->rudder;
}

static void ease_brakes(HandOver *hand_over, Controls *controls) {
    bool touched = controls->brake_left > 0.0 || controls->brake_right > 0.0;
    bool rolls = controls->throttle > hand_over->before.throttle + HAND_OVER_THROTTLE;
    hand_over->brakes = hand_over->brakes && !touched && !rolls;
    if (!hand_over->brakes)
        return;
    controls->brake_left = hand_over->before.brake_left;
    controls->brake_right = hand_over->before.brake_right;
}

void hand_over_ease(HandOver *hand_over, Controls *controls, double dt_s) {
    ease_brakes(hand_over, controls);
    if (hand_over->left_s <= 0.0)
        return;
    if (hand_over->begins)
        compare(hand_over, controls);
    double share = hand_over->left_s / HAND_OVER_S;
    controls->elevator += share * hand_over->elevator;
    controls->aileron = clamp(controls->aileron + share * hand_over->aileron, -1.0, 1.0);
    controls->rudder = clamp(controls->rudder + share * hand_over->rudder, -1.0, 1.0);
    hand_over->left_s -= dt_s;
}
