#include "input/devices/device_text.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#define REPLACEMENT 0xfffdu

// ---- Names --------------------------------------------------------------------------------------------------------

static bool is_printable(uint32_t code) {
    return code >= 0x20 && code != 0x7f && !(code >= 0x80 && code < 0xa0) && code <= 0x10ffff &&
           !(code >= 0xd800 && code < 0xe000);
}

// RFC 3629, section 3. Bytes used.
static size_t encode(uint32_t code, char out[4]) {
    static const uint8_t lead[4] = {0x00, 0xc0, 0xe0, 0xf0};
    size_t more = code < 0x80 ? 0 : code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
    out[0] = (char)(lead[more] | code >> (6 * more));
    for (size_t i = 1; i <= more; i++)
        out[i] = (char)(0x80 | (code >> (6 * (more - i)) & 0x3f));
    return more + 1;
}

static void from_wide(const wchar_t *text, char *out, size_t bytes) {
    size_t used = 0;
    for (; text && *text && used + 4 < bytes; text++)
        used += encode(is_printable((uint32_t)*text) ? (uint32_t)*text : REPLACEMENT, out + used);
    out[used] = '\0';
}

// What begins and ends with spaces, as fixed-width names do, is cut there.
static const char *trimmed(char *text) {
    size_t length = strlen(text);
    while (length > 0 && text[length - 1] == ' ')
        text[--length] = '\0';
    return text + strspn(text, " ");
}

void device_text_name(const wchar_t *maker, const wchar_t *product, PadInfo *info) {
    char maker_bytes[PAD_NAME_BYTES / 2 - 1], product_bytes[PAD_NAME_BYTES / 2]; // together with a space they fit
    from_wide(maker, maker_bytes, sizeof maker_bytes);
    from_wide(product, product_bytes, sizeof product_bytes);
    const char *whose = trimmed(maker_bytes), *what = trimmed(product_bytes);
    if (strstr(what, whose))
        whose = "";
    if (*whose || *what)
        snprintf(info->name, sizeof info->name, "%s%s%s", whose, *whose && *what ? " " : "", what);
    else
        snprintf(info->name, sizeof info->name, "%04x:%04x", info->vendor, info->product);
}

static void widen(const char *text, wchar_t out[PAD_NAME_BYTES]) {
    size_t count = 0;
    for (; text && text[count] && count + 1 < PAD_NAME_BYTES; count++)
        out[count] = (unsigned char)text[count] < 0x80 ? text[count] : (wchar_t)REPLACEMENT;
    out[count] = L'\0';
}

void device_text_name_bytes(const char *maker, const char *product, PadInfo *info) {
    wchar_t wide_maker[PAD_NAME_BYTES], wide_product[PAD_NAME_BYTES];
    widen(maker, wide_maker);
    widen(product, wide_product);
    device_text_name(wide_maker, wide_product, info);
}

// ---- Lines --------------------------------------------------------------------------------------------------------

static const char *plural(int count) {
    return count == 1 ? "" : "s";
}

void device_text_summary(const PadInfo *info, char out[DEVICE_TEXT_BYTES]) {
    snprintf(out, DEVICE_TEXT_BYTES, "%s (%04x:%04x) at %s: %d ax%ss, %d button%s, %d hat%s", info->name, info->vendor,
             info->product, info->path, info->axis_count, info->axis_count == 1 ? "i" : "e", info->button_count,
             plural(info->button_count), info->hat_count, plural(info->hat_count));
}

// The kernel names HID devices BUS:VENDOR:PRODUCT.NUMBER, Bluetooth's too, which have no idVendor.
void device_text_rule(const PadInfo *info, char out[DEVICE_TEXT_BYTES]) {
    const char *format = info->bus == PAD_BUS_HID
                             ? "KERNEL==\"hidraw*\", KERNELS==\"*:%04X:%04X.*\", TAG+=\"uaccess\""
                             : "SUBSYSTEM==\"usb\", ATTR{idVendor}==\"%04x\", ATTR{idProduct}==\"%04x\", "
                               "TAG+=\"uaccess\"";
    snprintf(out, DEVICE_TEXT_BYTES, format, info->vendor, info->product);
}

void device_text_denied(const PadInfo *info, int error, char out[DEVICE_TEXT_BYTES]) {
    const char *remedy = error == EBUSY ? "; another program uses it: end that"
                         : error == EACCES || error == EPERM
                             ? "; a udev rule allows it, and 'overfly devices' prints it and how to install it"
                             : "";
    snprintf(out, DEVICE_TEXT_BYTES, "%s (%04x:%04x) at %s cannot be read: %s%s", info->name, info->vendor,
             info->product, info->path, strerror(error), remedy);
}
