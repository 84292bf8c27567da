// Linked into executables of sanitized builds only. The leak sanitizer reports when the process ends, and leaves out
// what tools/lsan.supp names by library; GL drivers are unloaded before, and their leaks then have no name. So no
// library is unloaded.
int dlclose(void *handle);

int dlclose(void *handle) {
    (void)handle;
    return 0;
}
