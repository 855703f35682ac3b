/* Calls a kernel with a task that was written to a file, in a process of its own: for processors that are emulated. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int64_t flexstage_modes(const void *task);
int64_t flexstage_width(void);

/* Usage: driver task results. The file holds the size of the task, the task, and arrays: place in the task, bytes, whether it is a result,
 * content; results are written one after another. */
int main(int argc, char **argv)
{
    int64_t head[3], size;
    FILE *in = fopen(argv[1], "rb"), *out = fopen(argv[2], "wb");
    void *kept[64];
    int64_t bytes[64];
    int results = 0;
    if (argc != 3 || !in || !out || fread(&size, 8, 1, in) != 1) return 1;
    char *task = malloc(size);
    if (fread(task, 1, size, in) != (size_t)size) return 1;
    while (fread(head, 8, 3, in) == 3) {
        void *data = aligned_alloc(64, (head[1] + 127) / 64 * 64);
        if (fread(data, 1, head[1], in) != (size_t)head[1]) return 1;
        *(void **)(task + head[0]) = data;
        if (head[2]) kept[results] = data, bytes[results++] = head[1];
    }
    if (flexstage_modes(task)) return 2;
    for (int i = 0; i < results; i++) fwrite(kept[i], 1, bytes[i], out);
    printf("%d\n", (int)flexstage_width());
    return 0;
}
