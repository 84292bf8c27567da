#include "base/base.h"

const char *result_name(Result result) {
    switch (result) {
#define RESULT_NAME(name, text)                                                                                        \
    case RESULT_##name:                                                                                                \
        return #name;
        RESULT_TABLE(RESULT_NAME)
#undef RESULT_NAME
    }
    return "UNKNOWN";
}

const char *result_text(Result result) {
    switch (result) {
#define RESULT_TEXT(name, text)                                                                                        \
    case RESULT_##name:                                                                                                \
        return text;
        RESULT_TABLE(RESULT_TEXT)
#undef RESULT_TEXT
    }
    return "unknown result";
}
