// A program outside the tree: the headers' version is that of the library it runs with.
#include <girih/girih.h>
#include <stdio.h>

int main(void) {
    printf("headers %u, library %u\n", (unsigned)GIRIH_VERSION, (unsigned)girih_version());
    return girih_version() == GIRIH_VERSION && girih_catalogue_dyadic()->max == 6 ? 0 : 1;
}
