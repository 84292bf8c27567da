// terrain/diamond/diamond_lex.h: the words of a selection. Lengths become metres.
// Positions are characters from 0.
// Values; a token borrows the text.
#pragma once
#include "base/base.h"

typedef enum DiamondTokenKind {
    DIAMOND_TOKEN_END,
    DIAMOND_TOKEN_NUMBER,
    DIAMOND_TOKEN_NAME,
    DIAMOND_TOKEN_SIGN,     // an operator, a bracket or a comma
    DIAMOND_TOKEN_BAD,      // nothing that a selection may have
    DIAMOND_TOKEN_BAD_UNIT, // a number with an unknown unit
    DIAMOND_TOKEN_BAD_SIZE, // a number out of range
} DiamondTokenKind;

typedef struct DiamondToken {
    DiamondTokenKind kind;
    const char *text; // of `length` characters
    int length, position;
    double number;
    bool is_length; // it has a unit
} DiamondToken;

// The token at or after `position`; the next one begins at its position + length.
DiamondToken diamond_lex(const char *text, int position);
bool diamond_token_is(const DiamondToken *token, const char *word);
