/* A pump that is driven by C alone:
 *
 *     toothspace fmu egm12_pump --model full -o egm12_pump.machine
 *     cc example.c -I FOLDER -L FOLDER -Wl,-rpath,FOLDER -ltoothspace -o example
 *     ./example egm12_pump.machine
 *
 * with the FOLDER of the library that `toothspace --version -v` names.
 */
#include <stdio.h>
#include <toothspace.h>

int main(int count, char **words)
{
    char message[300];
    toothspace_machine *pump = toothspace_create(count > 1 ? words[1] : "", message, sizeof message);
    if (!pump) {
        fprintf(stderr, "%s\n", message);
        return 2;
    }
    int outlet = toothspace_find(pump, "outlet_pressure");
    int flow = toothspace_find(pump, "outlet_flow_rate");
    int torque = toothspace_find(pump, "shaft_torque");
    for (int k = 1; k <= 40; k++) {
        if (k == 20)
            toothspace_set(pump, outlet, 0.9 * toothspace_get(pump, outlet));
        int code = toothspace_step(pump, 1e-3 * k);
        if (code != TOOTHSPACE_DONE) {
            fprintf(stderr, "step %d ended with %d\n", k, code);
            return 3;
        }
        printf("%.3f s %10.4g bar %8.3f L/min %8.3f N m\n", toothspace_time(pump),
               1e-5 * toothspace_get(pump, outlet), 6e4 * toothspace_get(pump, flow),
               toothspace_get(pump, torque));
    }
    toothspace_destroy(pump);
    return 0;
}
