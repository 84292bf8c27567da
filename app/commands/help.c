#include "app/commands/help.h"

#include "app/version.h"
#include "config/files.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#define OPTION_COLUMN 30
#define SUMMARY_COLUMN 35
#define LINE_WIDTH 100

static const char *argument_of(const OptionSpec *spec) {
    return spec->argument ? spec->argument : spec->choices;
}

// Prints `text` from OPTION_COLUMN on, broken between words.
static void print_wrapped(const char *text) {
    int used = 0; // of the line
    while (*text) {
        int length = (int)strcspn(text, " ");
        if (used > 0 && OPTION_COLUMN + used + 1 + length > LINE_WIDTH) {
            printf("\n%*s", OPTION_COLUMN, "");
            used = 0;
        }
        used += printf("%s%.*s", used > 0 ? " " : "", length, text);
        text += length;
        text += *text == ' ';
    }
    putchar('\n');
}

static bool is_on_by_default(const OptionSpec *spec) {
    return spec->type == OPTION_TYPE_FLAG && strcmp(spec->default_text, "true") == 0;
}

static void print_option(const OptionSpec *spec) {
    char left[128], right[400];
    bool flag = spec->type == OPTION_TYPE_FLAG;
    int used =
        spec->letter ? snprintf(left, sizeof left, "  -%c, ", spec->letter) : snprintf(left, sizeof left, "      ");
    snprintf(left + used, sizeof left - (size_t)used, "--%s%s%s%s", is_on_by_default(spec) ? "[no-]" : "", spec->name,
             flag ? "" : " ", flag ? "" : argument_of(spec));
    bool show_default = spec->default_text && (!flag || is_on_by_default(spec));
    snprintf(right, sizeof right, "%s%s%s%s", spec->help, show_default ? " [" : "",
             show_default ? (flag ? "yes" : spec->default_text) : "", show_default ? "]" : "");
    if ((int)strlen(left) >= OPTION_COLUMN - 1)
        printf("%s\n%*s", left, OPTION_COLUMN, "");
    else
        printf("%-*s", OPTION_COLUMN, left);
    print_wrapped(right);
}

void help_print_command(const Command *command) {
    printf("usage: overfly %s [OPTION]...%s%s\n%c%s.\n\noptions [and their defaults]\n", command->name,
           *command->positionals ? " " : "", command->positionals, toupper((unsigned char)command->summary[0]),
           command->summary + 1);
    for (int i = 0; i < OPTION_COUNT; i++)
        if (option_spec((OptionId)i)->commands & command->id)
            print_option(option_spec((OptionId)i));
    char file[PATHS_BYTES_MAX];
    if (!files_user_config(file))
        snprintf(file, sizeof file, "$XDG_CONFIG_HOME/overfly/overfly.conf");
    printf("\nEvery option may also come from the environment (--max-triangles as OVERFLY_MAX_TRIANGLES) or from\n"
           "%s ('max-triangles = 100000', or the same under [%s]).\n"
           "The command line wins over the environment, the environment over the file.\n",
           file, command->name);
}

static void print_summary(const Command *command) {
    char left[128];
    snprintf(left, sizeof left, "  %-10s%s", command->name, command->positionals);
    if ((int)strlen(left) >= SUMMARY_COLUMN - 1)
        printf("%s\n%*s%s\n", left, SUMMARY_COLUMN, "", command->summary);
    else
        printf("%-*s%s\n", SUMMARY_COLUMN, left, command->summary);
}

void help_print_program(void) {
    printf("usage: overfly [SUBCOMMAND] [OPTION]... [SCENE|DEM]...\n"
           "Fly over real elevation models, drawn within a guaranteed error on the screen.\n\nsubcommands\n");
    for (const Command *command = command_table; command->name; command++)
        print_summary(command);
    printf("\nWithout a subcommand: fly; without a SCENE or DEM: the default scene.\n"
           "'overfly SUBCOMMAND --help' lists the options.\n");
}

void help_print_version(void) {
    printf("overfly %s\n", version_text());
}
