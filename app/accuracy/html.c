#include "app/accuracy/html.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>

#define FORMAT_BYTES 2048

void html_text(const char *text, FILE *to) {
    for (; *text; text++) {
        switch (*text) {
        case '&':
            fputs("&amp;", to);
            break;
        case '<':
            fputs("&lt;", to);
            break;
        case '>':
            fputs("&gt;", to);
            break;
        case '"':
            fputs("&quot;", to);
            break;
        default:
            fputc(*text, to);
        }
    }
}

void html_format(FILE *to, const char *format, ...) {
    char text[FORMAT_BYTES];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    html_text(text, to);
}

void html_element(const char *tag, const char *text, FILE *to) {
    fprintf(to, "<%s>", tag);
    html_text(text, to);
    fprintf(to, "</%s>\n", tag);
}

void html_begin_table(const char *const *titles, int count, FILE *to) {
    fputs("<div class=\"scroll\" tabindex=\"0\"><table class=\"sortable\"><thead><tr>", to);
    for (int i = 0; i < count; i++) {
        bool text = titles[i][0] == '<';
        fprintf(to, "<th scope=\"col\"%s>", text ? " class=\"text\"" : "");
        html_text(titles[i] + text, to);
        fputs("</th>", to);
    }
    fputs("</tr></thead><tbody>\n", to);
}

void html_begin_row(FILE *to) {
    fputs("<tr>", to);
}

void html_cell_text(const char *text, const char *css_class, FILE *to) {
    fprintf(to, "<td class=\"text%s%s\">", *css_class ? " " : "", css_class);
    html_text(text, to);
    fputs("</td>", to);
}

void html_cell_number(double value, int decimals, FILE *to) {
    if (isfinite(value))
        fprintf(to, "<td data-value=\"%.9g\">%.*f</td>", value, decimals, value);
    else
        fputs("<td>\xE2\x80\x93</td>", to);
}

void html_end_row(FILE *to) {
    fputs("</tr>\n", to);
}

void html_end_table(FILE *to) {
    fputs("</tbody></table></div>\n", to);
}

// RFC 4648, section 4.
static void put_base64(const unsigned char *bytes, size_t count, FILE *to) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < count; i += 3) {
        uint32_t three = (uint32_t)bytes[i] << 16;
        three |= i + 1 < count ? (uint32_t)bytes[i + 1] << 8 : 0;
        three |= i + 2 < count ? bytes[i + 2] : 0;
        fputc(digits[three >> 18], to);
        fputc(digits[three >> 12 & 63], to);
        fputc(i + 1 < count ? digits[three >> 6 & 63] : '=', to);
        fputc(i + 2 < count ? digits[three & 63] : '=', to);
    }
}

void html_picture(const HtmlPicture *picture, FILE *to) {
    fprintf(to, "<figure class=\"%s\"><img alt=\"", picture->css_class);
    html_text(picture->name, to);
    fprintf(to, "\" src=\"data:%s;base64,", picture->type);
    put_base64(picture->bytes, picture->count, to);
    fputs("\">", to);
    if (picture->caption)
        html_element("figcaption", picture->caption, to);
    fputs("</figure>\n", to);
}
