#include "config/suggest.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#define NAME_MAX_LENGTH 63

static int least(int a, int b) {
    return a < b ? a : b;
}

static bool same(char a, char b) {
    return tolower((unsigned char)a) == tolower((unsigned char)b);
}

// Optimal string alignment, three rows at a time.
int suggest_distance(const char *a, const char *b) {
    int m = (int)strlen(a), n = (int)strlen(b);
    if (m > NAME_MAX_LENGTH || n > NAME_MAX_LENGTH)
        return m > n ? m : n;
    int rows[3][NAME_MAX_LENGTH + 1];
    for (int j = 0; j <= n; j++)
        rows[0][j] = j;
    for (int i = 1; i <= m; i++) {
        int *row = rows[i % 3], *above = rows[(i + 2) % 3], *above2 = rows[(i + 1) % 3];
        row[0] = i;
        for (int j = 1; j <= n; j++) {
            row[j] = least(least(above[j], row[j - 1]) + 1, above[j - 1] + !same(a[i - 1], b[j - 1]));
            if (i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1]))
                row[j] = least(row[j], above2[j - 2] + 1);
        }
    }
    return rows[m % 3][n];
}

bool suggest_is_near(const char *typed, int distance) {
    int length = (int)strlen(typed);
    return distance <= (length <= 3 ? 1 : length <= 8 ? 2 : 3) && distance < length;
}

static bool begins_with(const char *name, const char *typed) {
    size_t length = strlen(typed);
    return length >= 2 && strncmp(name, typed, length) == 0;
}

const char *suggest_nearest(const char *typed, const char *const *names, int count) {
    const char *nearest = NULL;
    int nearest_distance = NAME_MAX_LENGTH;
    for (int i = 0; i < count; i++) {
        int distance = suggest_distance(typed, names[i]);
        if (distance < nearest_distance) {
            nearest_distance = distance;
            nearest = names[i];
        }
    }
    if (nearest && suggest_is_near(typed, nearest_distance))
        return nearest;
    for (int i = 0; i < count; i++)
        if (begins_with(names[i], typed))
            return names[i];
    return NULL;
}

const char *suggest_question(const char *typed, const char *const *names, int count, char out[SUGGEST_BYTES]) {
    const char *nearest = suggest_nearest(typed, names, count);
    out[0] = '\0';
    if (nearest)
        snprintf(out, SUGGEST_BYTES, "; did you mean '%s'?", nearest);
    return out;
}
