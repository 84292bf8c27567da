// Our own: the language of selections that makes Yalcin's arbitrary predicates (2011, section 4) something to type.
#include "terrain/diamond/diamond_lex.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NUMBER_MAX 1e30
#define NUMBER_CHARACTERS 63

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

static bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static int count_digits(const char *text) {
    int count = 0;
    while (is_digit(text[count]))
        count++;
    return count;
}

static int count_letters(const char *text) {
    int count = 0;
    while (is_letter(text[count]) || is_digit(text[count]))
        count++;
    return count;
}

// Characters of a decimal number without sign; 0: none.
static int count_number(const char *text) {
    int whole = count_digits(text), end = whole;
    if (text[end] == '.') {
        int fraction = count_digits(text + end + 1);
        if (whole + fraction == 0)
            return 0;
        end += 1 + fraction;
    }
    if (end == 0 || (text[end] != 'e' && text[end] != 'E'))
        return end;
    int sign = text[end + 1] == '-' || text[end + 1] == '+', power = count_digits(text + end + 1 + sign);
    return power > 0 ? end + 1 + sign + power : end;
}

// Metres; 0: no unit of length.
static double unit_metres(const char *text, int length) {
    static const struct {
        const char *name;
        double metres;
    } units[] = {{"m", 1.0}, {"km", 1000.0}, {"ft", 0.3048}, {"nmi", 1852.0}, {"mi", 1609.344}};
    for (size_t i = 0; i < COUNT_OF(units); i++)
        if ((int)strlen(units[i].name) == length && strncmp(units[i].name, text, (size_t)length) == 0)
            return units[i].metres;
    return 0.0;
}

static DiamondToken lex_number(DiamondToken token, int digits) {
    char copy[NUMBER_CHARACTERS + 1] = {0};
    int unit = count_letters(token.text + digits);
    token.kind = DIAMOND_TOKEN_NUMBER;
    token.length = digits + unit;
    token.is_length = unit > 0;
    double metres = unit > 0 ? unit_metres(token.text + digits, unit) : 1.0;
    if (metres == 0.0)
        token.kind = DIAMOND_TOKEN_BAD_UNIT;
    memcpy(copy, token.text, (size_t)(digits < NUMBER_CHARACTERS ? digits : NUMBER_CHARACTERS));
    token.number = strtod(copy, NULL) * metres;
    if (token.kind == DIAMOND_TOKEN_NUMBER && (digits > NUMBER_CHARACTERS || !(fabs(token.number) <= NUMBER_MAX)))
        token.kind = DIAMOND_TOKEN_BAD_SIZE;
    return token;
}

static DiamondToken lex_sign(DiamondToken token) {
    static const char *const signs[] = {"||", "&&", "<=", ">=", "<", ">", "!", "+", "-", "*", "(", ")", ","};
    for (size_t i = 0; i < COUNT_OF(signs); i++)
        if (strncmp(token.text, signs[i], strlen(signs[i])) == 0) {
            token.kind = DIAMOND_TOKEN_SIGN;
            token.length = (int)strlen(signs[i]);
            return token;
        }
    token.kind = DIAMOND_TOKEN_BAD;
    token.length = 1;
    return token;
}

DiamondToken diamond_lex(const char *text, int position) {
    position += (int)strspn(text + position, " \t\r\n");
    DiamondToken token = {.kind = DIAMOND_TOKEN_END, .text = text + position, .position = position};
    int digits = count_number(token.text);
    if (!*token.text)
        return token;
    if (digits > 0)
        return lex_number(token, digits);
    if (!is_letter(*token.text))
        return lex_sign(token);
    token.kind = DIAMOND_TOKEN_NAME;
    token.length = count_letters(token.text);
    return token;
}

bool diamond_token_is(const DiamondToken *token, const char *word) {
    return (token->kind == DIAMOND_TOKEN_NAME || token->kind == DIAMOND_TOKEN_SIGN) &&
           (int)strlen(word) == token->length && strncmp(token->text, word, (size_t)token->length) == 0;
}
