/* A server of libmodbus: input registers 0 to 119 are PV and OP of 60 loops, 120 counts the requests. */
#include <errno.h>
#include <math.h>
#include <modbus.h>
#include <netinet/in.h>
#include <stdio.h>
#include <string.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

int main(void)
{
    modbus_t *context = modbus_new_tcp("127.0.0.1", 0);
    modbus_mapping_t *map = modbus_mapping_new(0, 0, 0, 121);
    int listener = socket(AF_INET, SOCK_STREAM, 0);
    struct sockaddr_in at = { .sin_family = AF_INET, .sin_addr = { htonl(INADDR_LOOPBACK) } };
    socklen_t size = sizeof at;
    fd_set known;
    int highest = listener;

    if (bind(listener, (struct sockaddr *)&at, sizeof at) || listen(listener, 5)) return 1;
    getsockname(listener, (struct sockaddr *)&at, &size);
    printf("{\"port\": %d}\n", ntohs(at.sin_port));
    fflush(stdout);
    FD_ZERO(&known);
    FD_SET(listener, &known);
    for (;;) {
        fd_set ready = known;
        struct timeval wait = { 0, 20000 };
        struct timespec now;
        clock_gettime(CLOCK_REALTIME, &now);
        double t = now.tv_sec % 1000000 + 1e-9 * now.tv_nsec;
        for (int k = 0; k < 60; k++) {
            map->tab_input_registers[2 * k] = (uint16_t)(5000 + 500 * sin(t));
            map->tab_input_registers[2 * k + 1] = (uint16_t)(5000 - 500 * cos(t));
        }
        if (select(highest + 1, &ready, NULL, NULL, &wait) < 0) return 1;
        for (int fd = 0; fd <= highest; fd++) {
            uint8_t query[MODBUS_TCP_MAX_ADU_LENGTH];
            if (!FD_ISSET(fd, &ready)) continue;
            if (fd == listener) {
                int client = accept(listener, NULL, NULL);
                if (client >= 0) FD_SET(client, &known);
                if (client > highest) highest = client;
                continue;
            }
            modbus_set_socket(context, fd);
            int length = modbus_receive(context, query);
            if (length > 0) {
                map->tab_input_registers[120]++;
                modbus_reply(context, query, length, map);
            } else if (length == -1) {
                close(fd);
                FD_CLR(fd, &known);
            }
        }
    }
}
