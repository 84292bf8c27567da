#include "app/commands/command.h"
#include "app/demo/demo_list.h"
#include "app/flight/fly.h"
#include "app/json.h"
#include "base/log.h"

#include <stdio.h>
#include <string.h>

static Result print_json(const DemoList *list) {
    Json *json = json_create();
    Json *demos = json_add_array(json, "demos");
    for (int i = 0; i < list->count; i++) {
        Json *demo = json_append_object(demos);
        json_add_text(demo, "name", list->entries[i].name);
        json_add_text(demo, "title", list->entries[i].title);
    }
    Result result = json_print(json);
    json_destroy(&json);
    return result;
}

static Result print_list(const Options *options) {
    DemoList list;
    Result result = demo_list(&list);
    if (result == RESULT_OK && options_flag(options, OPTION_JSON))
        return print_json(&list);
    for (int i = 0; i < list.count && result == RESULT_OK; i++)
        printf("%-10s %s\n", list.entries[i].name, list.entries[i].title);
    return result;
}

static Result refuse_extra(const Options *options) {
    log_error("demo list: expected nothing more; found '%s'", options_positionals(options)[1]);
    return RESULT_USAGE;
}

Result cmd_demo(const Options *options) {
    const char *name = options_positional_count(options) > 0 ? options_positionals(options)[0] : "";
    if (strcmp(name, "list") == 0)
        return options_positional_count(options) == 1 ? print_list(options) : refuse_extra(options);
    if (*name)
        return fly_run(options, NULL);
    log_error("demo: expected 'list', or a demo's name; found nothing");
    return RESULT_USAGE;
}
