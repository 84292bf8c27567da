#include "input/hid/hid_descriptor.h"

#include "base/log.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define STACK_MAX 8        // Push; Linux allows 4
#define COLLECTIONS_MAX 32 // nested
#define RANGES_MAX 512     // of usages before one main item
#define VALUES_MAX 65536   // looked at; sticks have some hundred, and few bytes can claim millions
#define LONG_ITEM 0xfe

// Usage pages and usages: "HID Usage Tables" 1.12, sections 3, 4, 5 and 12.
#define PAGE_SIMULATION 0x02
#define PAGE_BUTTON 0x09
#define USAGE_JOYSTICK 0x00010004u
#define USAGE_GAMEPAD 0x00010005u
#define USAGE_MULTI_AXIS 0x00010008u
#define USAGE_HAT 0x00010039u

#define INPUT_CONSTANT 0x01u
#define INPUT_VARIABLE 0x02u
#define INPUT_RELATIVE 0x04u
#define INPUT_NULL_STATE 0x40u

// X(identifier, prefix without its size, name): short items, HID 1.11 section 6.2.2.2 to 6.2.2.8. Those that are not
// here carry nothing for us: units, designators, strings, what is reserved.
#define ITEM_TABLE(X)                                                                                                  \
    X(INPUT, 0x80, "Input")                                                                                            \
    X(OUTPUT, 0x90, "Output")                                                                                          \
    X(COLLECTION, 0xa0, "Collection")                                                                                  \
    X(FEATURE, 0xb0, "Feature")                                                                                        \
    X(END_COLLECTION, 0xc0, "End Collection")                                                                          \
    X(USAGE_PAGE, 0x04, "Usage Page")                                                                                  \
    X(LOGICAL_MINIMUM, 0x14, "Logical Minimum")                                                                        \
    X(LOGICAL_MAXIMUM, 0x24, "Logical Maximum")                                                                        \
    X(PHYSICAL_MINIMUM, 0x34, "Physical Minimum")                                                                      \
    X(PHYSICAL_MAXIMUM, 0x44, "Physical Maximum")                                                                      \
    X(REPORT_SIZE, 0x74, "Report Size")                                                                                \
    X(REPORT_ID, 0x84, "Report ID")                                                                                    \
    X(REPORT_COUNT, 0x94, "Report Count")                                                                              \
    X(PUSH, 0xa4, "Push")                                                                                              \
    X(POP, 0xb4, "Pop")                                                                                                \
    X(USAGE, 0x08, "Usage")                                                                                            \
    X(USAGE_MINIMUM, 0x18, "Usage Minimum")                                                                            \
    X(USAGE_MAXIMUM, 0x28, "Usage Maximum")                                                                            \
    X(DELIMITER, 0xa8, "Delimiter")

enum {
#define ITEM_ENUM(id, prefix, name) ITEM_##id = prefix,
    ITEM_TABLE(ITEM_ENUM)
#undef ITEM_ENUM
};

typedef struct Item {
    size_t offset;
    uint8_t prefix;
    int kind; // ITEM_*
    int bytes;
    uint32_t data;
    int32_t signed_data;
} Item;

typedef struct Extent {
    int64_t min, max_signed, max_unsigned;
} Extent;

typedef struct Globals {
    uint32_t usage_page;
    Extent logical, physical;
    uint32_t report_size, report_count;
    uint8_t report_id;
} Globals;

typedef struct Range {
    uint32_t first, last; // page in the upper 16 bits
    bool is_extended;     // it told its page itself
} Range;

typedef struct Locals {
    Range ranges[RANGES_MAX];
    int range_count;
    Item minimum, maximum; // bytes < 0: not told yet
    bool in_alternatives;  // between delimiters, which list usages of one control, the preferred first
    bool has_alternative;
} Locals;

typedef struct Parser {
    Globals globals, stack[STACK_MAX];
    int stack_depth;
    Locals locals;
    bool is_pad[COLLECTIONS_MAX + 1]; // by depth: inside of a pad's application collection
    int depth;
    uint32_t report_bits[256];
    uint32_t values_seen;
    HidDescriptor *out;
} Parser;

// ---- Items ------------------------------------------------------------------------------------------------------

static const char *item_name(int kind) {
    switch (kind) {
#define ITEM_CASE(id, prefix, name)                                                                                    \
    case prefix:                                                                                                       \
        return name;
        ITEM_TABLE(ITEM_CASE)
#undef ITEM_CASE
    default:
        return "of another kind";
    }
}

PRINTF_LIKE(2, 3) static Result refuse(const Item *item, const char *format, ...) {
    char what[160];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    log_error("HID report descriptor, byte %zu, item 0x%02x (%s): %s; the device cannot be used", item->offset,
              item->prefix, item_name(item->kind), what);
    return RESULT_FORMAT;
}

static int32_t sign_extended(uint32_t value, int bits) {
    uint32_t sign = 1u << (bits - 1);
    return (int32_t)((value ^ sign) - sign);
}

// The item at `offset`, and where the next begins. A long item is skipped: none is defined.
static Result read_item(const uint8_t *bytes, size_t count, size_t offset, Item *item, size_t *next) {
    static const int sizes[4] = {0, 1, 2, 4};
    uint8_t prefix = bytes[offset];
    *item = (Item){.offset = offset, .prefix = prefix, .kind = prefix & 0xfc, .bytes = sizes[prefix & 3]};
    size_t data = offset + 1, length = (size_t)item->bytes;
    if (prefix == LONG_ITEM) {
        length = offset + 1 < count ? 2u + bytes[offset + 1] : 2u;
        item->bytes = 0;
    }
    if (length > count - data)
        return refuse(item, "expected %zu bytes of data, found %zu before the end", length, count - data);
    for (int i = 0; i < item->bytes; i++)
        item->data |= (uint32_t)bytes[data + (size_t)i] << (8 * i);
    item->signed_data = item->bytes > 0 ? sign_extended(item->data, 8 * item->bytes) : 0;
    *next = data + length;
    return RESULT_OK;
}

// ---- Global items -----------------------------------------------------------------------------------------------

// Devices write a maximum of 255 in one byte: a maximum is signed where its minimum is below 0, which may come later.
static int64_t maximum_of(const Extent *extent) {
    return extent->min < 0 ? extent->max_signed : extent->max_unsigned;
}

static void set_maximum(Extent *extent, const Item *item) {
    extent->max_signed = item->signed_data;
    extent->max_unsigned = item->data;
}

static Result set_report_id(Parser *parser, const Item *item) {
    if (item->data < 1 || item->data > 255)
        return refuse(item, "expected a report id of 1 to 255, found %u", item->data);
    parser->globals.report_id = (uint8_t)item->data;
    parser->out->has_report_ids = true;
    return RESULT_OK;
}

static Result push(Parser *parser, const Item *item) {
    if (parser->stack_depth == STACK_MAX)
        return refuse(item, "more than %d pushes", STACK_MAX);
    parser->stack[parser->stack_depth++] = parser->globals;
    return RESULT_OK;
}

static Result pop(Parser *parser, const Item *item) {
    if (parser->stack_depth == 0)
        return refuse(item, "nothing was pushed");
    parser->globals = parser->stack[--parser->stack_depth];
    return RESULT_OK;
}

// ---- Local items ------------------------------------------------------------------------------------------------

static void clear_locals(Locals *locals) {
    locals->range_count = 0;
    locals->minimum.bytes = locals->maximum.bytes = -1;
    locals->in_alternatives = locals->has_alternative = false;
}

static bool continues(const Range *last, const Range *next) {
    return !last->is_extended && !next->is_extended && next->first == last->last + 1 &&
           next->first >> 16 == last->first >> 16;
}

static Result add_range(Locals *locals, const Item *item, Range range) {
    if (locals->in_alternatives && locals->has_alternative)
        return RESULT_OK;
    locals->has_alternative = true;
    if (locals->range_count > 0 && continues(&locals->ranges[locals->range_count - 1], &range)) {
        locals->ranges[locals->range_count - 1].last = range.last;
        return RESULT_OK;
    }
    if (locals->range_count == RANGES_MAX)
        return refuse(item, "more than %d ranges of usages for one field", RANGES_MAX);
    locals->ranges[locals->range_count++] = range;
    return RESULT_OK;
}

// With its page: four bytes bring their own, fewer take the present one.
static uint32_t whole_usage(const Parser *parser, const Item *item) {
    return item->bytes == 4 ? item->data : parser->globals.usage_page << 16 | item->data;
}

static Result add_usage(Parser *parser, const Item *item) {
    uint32_t usage = whole_usage(parser, item);
    return add_range(&parser->locals, item, (Range){usage, usage, item->bytes == 4});
}

// A minimum and a maximum in either order make a range, once both are there.
static Result close_range(Parser *parser, const Item *item) {
    Locals *locals = &parser->locals;
    if (locals->minimum.bytes < 0 || locals->maximum.bytes < 0)
        return RESULT_OK;
    uint32_t first = whole_usage(parser, &locals->minimum);
    uint32_t last = (first & 0xffff0000u) | (locals->maximum.data & 0xffffu);
    bool is_extended = locals->minimum.bytes == 4;
    locals->minimum.bytes = locals->maximum.bytes = -1;
    return last < first ? RESULT_OK : add_range(locals, item, (Range){first, last, is_extended});
}

static Result delimit(Parser *parser, const Item *item) {
    parser->locals.in_alternatives = item->data == 1;
    parser->locals.has_alternative = false;
    return RESULT_OK;
}

// The last page declared holds for the usages before it, too, unless they were followed by others of that page: what
// HID 1.11 section 6.2.2.7 says, and what devices that change the page between usages mean.
static void settle_pages(Parser *parser) {
    Locals *locals = &parser->locals;
    for (int i = locals->range_count - 1; i >= 0; i--) {
        Range *range = &locals->ranges[i];
        if (range->is_extended)
            continue;
        if (range->first >> 16 == parser->globals.usage_page)
            break;
        range->first = parser->globals.usage_page << 16 | (range->first & 0xffffu);
        range->last = parser->globals.usage_page << 16 | (range->last & 0xffffu);
    }
}

// ---- Fields -----------------------------------------------------------------------------------------------------

static const struct {
    uint32_t usage;
    PadAxisKind kind;
} axis_usages[] = {
    {0x00010030, PAD_AXIS_X},        {0x00010031, PAD_AXIS_Y},           {0x00010032, PAD_AXIS_Z},
    {0x00010033, PAD_AXIS_RX},       {0x00010034, PAD_AXIS_RY},          {0x00010035, PAD_AXIS_RZ},
    {0x00010036, PAD_AXIS_SLIDER},   {0x00010037, PAD_AXIS_DIAL},        {0x00010038, PAD_AXIS_WHEEL},
    {0x000200b0, PAD_AXIS_AILERON},  {0x000200b8, PAD_AXIS_ELEVATOR},    {0x000200ba, PAD_AXIS_RUDDER},
    {0x000200bb, PAD_AXIS_THROTTLE}, {0x000200c4, PAD_AXIS_ACCELERATOR}, {0x000200c5, PAD_AXIS_BRAKE},
};

// PAD_AXIS_KIND_COUNT: no axis. Other controls of the Simulation page (B0..D0) are axes where they are no switches.
static PadAxisKind axis_of_usage(uint32_t usage, int bits) {
    for (size_t i = 0; i < COUNT_OF(axis_usages); i++)
        if (axis_usages[i].usage == usage)
            return axis_usages[i].kind;
    bool is_simulation = usage >= 0x000200b0 && usage <= 0x000200d0 && bits > 1;
    return is_simulation ? PAD_AXIS_OTHER : PAD_AXIS_KIND_COUNT;
}

static void add_field(HidDescriptor *out, HidField field, int *counter, int limit) {
    int width = field.kind == HID_FIELD_BUTTON_ARRAY ? field.button_count : 1;
    if (*counter + width > limit || out->field_count == HID_FIELDS_MAX)
        return;
    field.index = *counter;
    *counter += width;
    out->fields[out->field_count++] = field;
}

static void add_variable(HidDescriptor *out, HidField field, uint32_t usage) {
    PadAxisKind axis = axis_of_usage(usage, field.bits);
    if (axis != PAD_AXIS_KIND_COUNT) {
        field.kind = HID_FIELD_AXIS;
        field.axis = axis;
        add_field(out, field, &out->axis_count, PAD_AXES_MAX);
    } else if (usage == USAGE_HAT) {
        field.kind = HID_FIELD_HAT;
        add_field(out, field, &out->hat_count, PAD_HATS_MAX);
    } else if (usage >> 16 == PAGE_BUTTON && (usage & 0xffffu) > 0) {
        field.kind = HID_FIELD_BUTTON;
        add_field(out, field, &out->button_count, PAD_BUTTONS_MAX);
    }
}

// Each value has the next usage; the last usage is that of all values that are left. Of buttons those are padding:
// devices that declare 128 bits for 29 buttons are sold.
static void add_variables(Parser *parser, HidField field, uint32_t count) {
    const Locals *locals = &parser->locals;
    int range = 0;
    uint32_t usage = locals->ranges[0].first;
    for (uint32_t i = 0; i < count && parser->values_seen < VALUES_MAX; i++, parser->values_seen++) {
        add_variable(parser->out, field, usage);
        field.bit += field.bits;
        if (usage < locals->ranges[range].last)
            usage++;
        else if (range + 1 < locals->range_count)
            usage = locals->ranges[++range].first;
        else if (usage >> 16 == PAGE_BUTTON)
            break;
    }
}

// An array's values number the usages of its range, from the logical minimum; usage 0 of buttons is none.
static void add_button_array(Parser *parser, HidField field, uint32_t count) {
    const Range *range = &parser->locals.ranges[0];
    if (range->first >> 16 != PAGE_BUTTON)
        return;
    bool from_none = (range->first & 0xffffu) == 0;
    int64_t buttons = (int64_t)range->last - range->first + !from_none, room = PAD_BUTTONS_MAX;
    int64_t values = field.logical_max - field.logical_min + !from_none;
    room -= parser->out->button_count;
    buttons = buttons < values ? buttons : values;
    field.kind = HID_FIELD_BUTTON_ARRAY;
    field.slots = (uint16_t)count;
    field.first_value = field.logical_min + from_none;
    field.button_count = (int)(buttons < room ? buttons : room);
    if (field.button_count > 0)
        add_field(parser->out, field, &parser->out->button_count, PAD_BUTTONS_MAX);
}

static HidField begin_field(const Parser *parser, const Item *item, uint32_t bit) {
    const Globals *globals = &parser->globals;
    return (HidField){.report_id = globals->report_id,
                      .bits = (uint8_t)globals->report_size,
                      .has_null = item->data & INPUT_NULL_STATE,
                      .slots = 1,
                      .bit = bit,
                      .logical_min = globals->logical.min,
                      .logical_max = maximum_of(&globals->logical),
                      .physical_min = globals->physical.min,
                      .physical_max = maximum_of(&globals->physical)};
}

// Whether the values of this Input item can be controls of a pad at all.
static bool is_of_use(const Parser *parser, const Item *item) {
    const Globals *globals = &parser->globals;
    return parser->is_pad[parser->depth] && !(item->data & (INPUT_CONSTANT | INPUT_RELATIVE)) &&
           globals->report_size >= 1 && globals->report_size <= 32 && parser->locals.range_count > 0 &&
           globals->logical.min < maximum_of(&globals->logical);
}

static Result add_input(Parser *parser, const Item *item) {
    const Globals *globals = &parser->globals;
    uint32_t *used = &parser->report_bits[globals->report_id];
    uint32_t bit = *used > 0 || globals->report_id == 0 ? *used : 8;
    uint64_t bits = (uint64_t)globals->report_size * globals->report_count;
    if (bits > HID_REPORT_BYTES_MAX * 8u - bit)
        return refuse(item, "%u values of %u bits make the report longer than %d bytes", globals->report_count,
                      globals->report_size, HID_REPORT_BYTES_MAX);
    *used = bit + (uint32_t)bits;
    settle_pages(parser);
    if (!is_of_use(parser, item) || bits == 0)
        return RESULT_OK;
    HidField field = begin_field(parser, item, bit);
    if (item->data & INPUT_VARIABLE)
        add_variables(parser, field, globals->report_count);
    else
        add_button_array(parser, field, globals->report_count);
    return RESULT_OK;
}

// ---- Collections ------------------------------------------------------------------------------------------------

static bool is_pad_usage(uint32_t usage) {
    return usage == USAGE_JOYSTICK || usage == USAGE_GAMEPAD || usage == USAGE_MULTI_AXIS ||
           usage >> 16 == PAGE_SIMULATION;
}

static Result open_collection(Parser *parser, const Item *item) {
    const uint32_t application = 1;
    if (parser->depth == COLLECTIONS_MAX)
        return refuse(item, "more than %d collections in one another", COLLECTIONS_MAX);
    settle_pages(parser);
    bool is_pad = parser->is_pad[parser->depth];
    if (item->data == application)
        is_pad = parser->locals.range_count > 0 && is_pad_usage(parser->locals.ranges[0].first);
    parser->is_pad[++parser->depth] = is_pad;
    return RESULT_OK;
}

static Result close_collection(Parser *parser, const Item *item) {
    if (parser->depth == 0)
        return refuse(item, "no collection is open");
    parser->depth--;
    return RESULT_OK;
}

// ---- The whole --------------------------------------------------------------------------------------------------

static Result main_item(Parser *parser, const Item *item) {
    Result result = RESULT_OK;
    if (item->kind == ITEM_INPUT)
        result = add_input(parser, item);
    else if (item->kind == ITEM_COLLECTION)
        result = open_collection(parser, item);
    else if (item->kind == ITEM_END_COLLECTION)
        result = close_collection(parser, item);
    clear_locals(&parser->locals);
    return result;
}

static Result take_range_end(Parser *parser, const Item *item) {
    if (item->kind == ITEM_USAGE_MINIMUM)
        parser->locals.minimum = *item;
    else
        parser->locals.maximum = *item;
    return close_range(parser, item);
}

static Result take_global(Parser *parser, const Item *item) {
    Globals *globals = &parser->globals;
    switch (item->kind) {
    case ITEM_USAGE_PAGE:
        globals->usage_page = item->data & 0xffffu;
        break;
    case ITEM_LOGICAL_MINIMUM:
        globals->logical.min = item->signed_data;
        break;
    case ITEM_LOGICAL_MAXIMUM:
        set_maximum(&globals->logical, item);
        break;
    case ITEM_PHYSICAL_MINIMUM:
        globals->physical.min = item->signed_data;
        break;
    case ITEM_PHYSICAL_MAXIMUM:
        set_maximum(&globals->physical, item);
        break;
    case ITEM_REPORT_SIZE:
        globals->report_size = item->data;
        break;
    case ITEM_REPORT_COUNT:
        globals->report_count = item->data;
        break;
    case ITEM_REPORT_ID:
        return set_report_id(parser, item);
    case ITEM_PUSH:
        return push(parser, item);
    case ITEM_POP:
        return pop(parser, item);
    default:
        break;
    }
    return RESULT_OK;
}

static Result take_local(Parser *parser, const Item *item) {
    switch (item->kind) {
    case ITEM_USAGE:
        return add_usage(parser, item);
    case ITEM_USAGE_MINIMUM:
    case ITEM_USAGE_MAXIMUM:
        return take_range_end(parser, item);
    case ITEM_DELIMITER:
        return delimit(parser, item);
    default:
        return RESULT_OK;
    }
}

static Result take_item(Parser *parser, const Item *item) {
    enum { MAIN, GLOBAL, LOCAL, RESERVED }; // long items are of the last
    switch (item->kind >> 2 & 3) {
    case MAIN:
        return main_item(parser, item);
    case GLOBAL:
        return take_global(parser, item);
    case LOCAL:
        return take_local(parser, item);
    case RESERVED:
    default:
        return RESULT_OK;
    }
}

static Result parse_items(Parser *parser, const uint8_t *bytes, size_t count) {
    Item item = {.bytes = 0};
    for (size_t offset = 0; offset < count;) {
        Result result = read_item(bytes, count, offset, &item, &offset);
        if (result == RESULT_OK)
            result = take_item(parser, &item);
        if (result != RESULT_OK)
            return result;
    }
    return parser->depth == 0 ? RESULT_OK
                              : refuse(&item, "the descriptor ends with %d collections open", parser->depth);
}

static void note_report_lengths(const Parser *parser, HidDescriptor *out) {
    for (int id = 0; id < 256; id++)
        out->report_bytes[id] = (uint16_t)((parser->report_bits[id] + 7) / 8);
    if (out->has_report_ids)
        out->report_bytes[0] = 0;
}

Result hid_descriptor_parse(const uint8_t *bytes, size_t count, HidDescriptor *out) {
    Parser parser = {.out = out};
    *out = (HidDescriptor){.field_count = 0};
    if (count > HID_DESCRIPTOR_BYTES_MAX) {
        log_error("HID report descriptor: %zu bytes, more than %d; the device cannot be used", count,
                  HID_DESCRIPTOR_BYTES_MAX);
        return RESULT_FORMAT;
    }
    clear_locals(&parser.locals);
    Result result = parse_items(&parser, bytes, count);
    if (result != RESULT_OK)
        return result;
    note_report_lengths(&parser, out);
    return out->field_count > 0 ? RESULT_OK : RESULT_UNSUPPORTED;
}

void hid_describe(const HidDescriptor *descriptor, PadInfo *info) {
    info->axis_count = descriptor->axis_count;
    info->button_count = descriptor->button_count;
    info->hat_count = descriptor->hat_count;
    for (int i = 0; i < descriptor->field_count; i++) {
        const HidField *field = &descriptor->fields[i];
        if (field->kind != HID_FIELD_AXIS)
            continue;
        info->axes[field->index] = field->axis;
        info->ranges[field->index] = (PadRange){field->logical_min, field->logical_max};
    }
}
