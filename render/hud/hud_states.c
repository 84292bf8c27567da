// What is set otherwise than for flying on, in one place that every window has: words below the heading.
#include "render/hud/hud_paint.h"

#include <math.h>
#include <stdio.h>

#define STATES_MAX 6
#define STATE_BYTES 64
#define GAP_EM 0.8f       // between words
#define NEUTRAL 0.005     // of trim and rudder, and of flaps that are up
#define SHORTEST_EM 0.001 // of a row without words

typedef struct State {
    char text[STATE_BYTES];
    CanvasColour colour;
} State;

// In the order in which they are read, the urgent first.
typedef struct States {
    State list[STATES_MAX];
    int count;
} States;

static void add(States *states, const char *text, CanvasColour colour) {
    State *state = &states->list[states->count++];
    snprintf(state->text, sizeof state->text, "%s", text);
    state->colour = colour;
}

static void add_gear(States *states, const RenderHud *hud) {
    bool moves = hud->gear > 0.0 && hud->gear < 1.0;
    if (hud->gear_retracts)
        add(states, moves ? "GEAR \xE2\x80\xA6" : hud->gear > 0.0 ? "GEAR DN" : "GEAR UP", moves ? HUD_WARN : HUD_INK);
}

static void add_percent(States *states, const char *name, double share, bool sign) {
    char number[HUD_NUMBER_BYTES], text[STATE_BYTES];
    if (!(fabs(share) >= NEUTRAL))
        return;
    if (sign)
        hud_format_signed(number, share * 100.0, 0);
    else
        hud_format_fixed(number, share * 100.0, 0);
    snprintf(text, sizeof text, "%s %s %%", name, number);
    add(states, text, HUD_INK);
}

static States states_of(const RenderHud *hud) {
    States states = {.count = 0};
    if (hud->brakes)
        add(&states, "BRAKE", HUD_WARN);
    add_gear(&states, hud);
    add_percent(&states, "FLP", hud->flaps, false);
    if (hud->autopilot)
        add(&states, "AP", HUD_ACCENT);
    add_percent(&states, "TRIM", hud->trim, true);
    add_percent(&states, hud->rudder < 0.0 ? "RUD L" : "RUD R", fabs(hud->rudder), false);
    return states;
}

// Of the words from..to - 1, em.
static float row_em(const HudPainter *painter, const States *states, int from, int to) {
    float em = (float)(to - from - 1) * GAP_EM;
    for (int i = from; i < to; i++)
        em += text_width_px(painter->text, states->list[i].text, 1.0f);
    return fmaxf(em, SHORTEST_EM);
}

static void paint_row(const HudPainter *painter, const States *states, int from, int to, int row) {
    const HudLayout *layout = &painter->layout;
    float em = row_em(painter, states, from, to), room = layout->states.x1 - layout->states.x0;
    float size = fminf(layout->small_px, room / em), x = layout->centre.x - 0.5f * em * size;
    float y = hud_baseline(painter, layout->states.y0 + ((float)row + 0.5f) * layout->row_px, size);
    for (int i = from; i < to; i++) {
        const State *state = &states->list[i];
        hud_text(painter, (CanvasPoint){x, y}, size, CANVAS_LEFT, state->colour, state->text);
        x += (text_width_px(painter->text, state->text, 1.0f) + GAP_EM) * size;
    }
}

// How many words the first row takes: all, or what fits where there is a second one.
static int first_row_count(const HudPainter *painter, const States *states) {
    const HudLayout *layout = &painter->layout;
    float room = (layout->states.x1 - layout->states.x0) / layout->small_px;
    bool two = layout->states.y1 - layout->states.y0 > 1.5f * layout->row_px;
    int count = states->count;
    while (two && count > 1 && row_em(painter, states, 0, count) > room)
        count--;
    return count;
}

void hud_paint_states(const HudPainter *painter, const RenderHud *hud) {
    const States states = states_of(hud);
    int first = first_row_count(painter, &states);
    paint_row(painter, &states, 0, first, 0);
    paint_row(painter, &states, first, states.count, 1);
}
