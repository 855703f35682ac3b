/* FMI 2.0 for Co-Simulation around a fixed-step program: only the functions of the standard.
 * model.h selects the program. The importer provides memory. The state contains only numbers, so that a copy saves it. */
#include "model.h"

#include <stddef.h>
#include <string.h>

#ifdef FMI2_FUNCTION_PREFIX
#define JOINED_(a, b) a##b
#define JOINED(a, b) JOINED_(a, b)
#define NAMED(name) JOINED(FMI2_FUNCTION_PREFIX, name)
#else
#define NAMED(name) name
#endif

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define EXPORT __attribute__((visibility("default")))
#else
#define EXPORT
#endif

typedef void *Component;
typedef unsigned int Reference;
typedef const char *String;
typedef int Boolean;
typedef enum { OK, WARNING, DISCARD, ERROR, FATAL, PENDING } Status;
typedef enum { INSTANTIATED = 1, INITIALISING = 2, STEPPING = 4, TERMINATED = 8 } Mode;

typedef struct {
    void (*logger)(void *environment, String instance, Status status, String category, String message, ...);
    void *(*allocate)(size_t count, size_t size);
    void (*release)(void *memory);
    void (*finished)(void *environment, Status status);
    void *environment;
} Callbacks;

/* All variables of the FMU state, which the importer can get, set and serialise. */
typedef struct {
    model_state state;
    double in[MODEL_INPUTS];
    double out[MODEL_OUTPUTS];
    double start;
    double done;
    int mode;
} Kept;

typedef struct {
    Kept kept;
    const Callbacks *callbacks;
    char *name;
} Instance;

static Status told(const Instance *instance, String what)
{
    instance->callbacks->logger(instance->callbacks->environment, instance->name, ERROR, "logStatusError", "%s", what);
    return ERROR;
}

static void at_rest(Kept *kept)
{
    memset(kept, 0, sizeof *kept);
    MODEL_INIT(&kept->state);
    kept->mode = INSTANTIATED;
}

/* Compute the outputs of the first sample without a change of the state: there is no earlier sample. */
static void look_ahead(Kept *kept)
{
    model_state state = kept->state;
    model_input in;
    model_output out;
    memcpy(&in, kept->in, sizeof in);
    MODEL_STEP(&state, &in, &out);
    memcpy(kept->out, &out, sizeof out);
}

static int is_in(const Instance *instance, int modes)
{
    return (instance->kept.mode & modes) != 0;
}

EXPORT String NAMED(fmi2GetTypesPlatform)(void);
EXPORT String NAMED(fmi2GetTypesPlatform)(void)
{
    return "default";
}

EXPORT String NAMED(fmi2GetVersion)(void);
EXPORT String NAMED(fmi2GetVersion)(void)
{
    return "2.0";
}

EXPORT Status NAMED(fmi2SetDebugLogging)(Component c, Boolean on, size_t count, const String categories[]);
EXPORT Status NAMED(fmi2SetDebugLogging)(Component c, Boolean on, size_t count, const String categories[])
{
    (void)c, (void)on, (void)count, (void)categories;
    return OK;
}

EXPORT Component NAMED(fmi2Instantiate)(String name, int type, String guid, String resources, const Callbacks *callbacks,
                                        Boolean visible, Boolean logging);
EXPORT Component NAMED(fmi2Instantiate)(String name, int type, String guid, String resources, const Callbacks *callbacks,
                                        Boolean visible, Boolean logging)
{
    Instance *instance;
    size_t length;
    (void)resources, (void)visible, (void)logging;
    if (callbacks == NULL || callbacks->logger == NULL || callbacks->allocate == NULL || callbacks->release == NULL) return NULL;
    if (name == NULL || name[0] == '\0' || type != 1 || guid == NULL || strcmp(guid, MODEL_GUID) != 0) {
        callbacks->logger(callbacks->environment, name == NULL ? "?" : name, ERROR, "logStatusError",
                          "%s", "instantiation needs a name, the type Co-Simulation and the GUID of modelDescription.xml");
        return NULL;
    }
    instance = callbacks->allocate(1, sizeof *instance);
    if (instance == NULL) return NULL;
    length = strlen(name) + 1;
    instance->callbacks = callbacks;
    instance->name = callbacks->allocate(length, 1);
    if (instance->name == NULL) {
        callbacks->release(instance);
        return NULL;
    }
    memcpy(instance->name, name, length);
    at_rest(&instance->kept);
    return instance;
}

EXPORT void NAMED(fmi2FreeInstance)(Component c);
EXPORT void NAMED(fmi2FreeInstance)(Component c)
{
    Instance *instance = c;
    if (instance == NULL) return;
    instance->callbacks->release(instance->name);
    instance->callbacks->release(instance);
}

EXPORT Status NAMED(fmi2SetupExperiment)(Component c, Boolean bounded, double tolerance, double start, Boolean ends, double stop);
EXPORT Status NAMED(fmi2SetupExperiment)(Component c, Boolean bounded, double tolerance, double start, Boolean ends, double stop)
{
    Instance *instance = c;
    (void)bounded, (void)tolerance, (void)ends, (void)stop;
    if (!is_in(instance, INSTANTIATED)) return told(instance, "the experiment can be set up only before initialisation");
    instance->kept.start = start;
    return OK;
}

EXPORT Status NAMED(fmi2EnterInitializationMode)(Component c);
EXPORT Status NAMED(fmi2EnterInitializationMode)(Component c)
{
    Instance *instance = c;
    if (!is_in(instance, INSTANTIATED)) return told(instance, "initialisation can begin only once after instantiation or reset");
    instance->kept.mode = INITIALISING;
    return OK;
}

EXPORT Status NAMED(fmi2ExitInitializationMode)(Component c);
EXPORT Status NAMED(fmi2ExitInitializationMode)(Component c)
{
    Instance *instance = c;
    if (!is_in(instance, INITIALISING)) return told(instance, "the FMU is not in initialisation mode");
    look_ahead(&instance->kept);
    instance->kept.mode = STEPPING;
    return OK;
}

EXPORT Status NAMED(fmi2Terminate)(Component c);
EXPORT Status NAMED(fmi2Terminate)(Component c)
{
    Instance *instance = c;
    if (!is_in(instance, STEPPING)) return told(instance, "the FMU is not in step mode");
    instance->kept.mode = TERMINATED;
    return OK;
}

EXPORT Status NAMED(fmi2Reset)(Component c);
EXPORT Status NAMED(fmi2Reset)(Component c)
{
    at_rest(&((Instance *)c)->kept);
    return OK;
}

EXPORT Status NAMED(fmi2GetReal)(Component c, const Reference references[], size_t count, double values[]);
EXPORT Status NAMED(fmi2GetReal)(Component c, const Reference references[], size_t count, double values[])
{
    Instance *instance = c;
    size_t i;
    if (is_in(instance, INSTANTIATED | INITIALISING)) look_ahead(&instance->kept);
    for (i = 0; i < count; i++) {
        const Reference number = references[i];
        if (number >= MODEL_INPUTS + MODEL_OUTPUTS) return told(instance, "no variable has this value reference");
        values[i] = number < MODEL_INPUTS ? instance->kept.in[number] : instance->kept.out[number - MODEL_INPUTS];
    }
    return OK;
}

EXPORT Status NAMED(fmi2SetReal)(Component c, const Reference references[], size_t count, const double values[]);
EXPORT Status NAMED(fmi2SetReal)(Component c, const Reference references[], size_t count, const double values[])
{
    Instance *instance = c;
    size_t i;
    if (!is_in(instance, INSTANTIATED | INITIALISING | STEPPING)) return told(instance, "inputs cannot be set after termination");
    for (i = 0; i < count; i++) {
        if (references[i] >= MODEL_INPUTS) return told(instance, "no input has this value reference");
        instance->kept.in[references[i]] = values[i];
    }
    return OK;
}

/* Variables of other types do not exist: every reference to one is an error. */
#define NO_GETTER(function, type)                                                                                              \
    EXPORT Status NAMED(function)(Component c, const Reference references[], size_t count, type values[]);                     \
    EXPORT Status NAMED(function)(Component c, const Reference references[], size_t count, type values[])                      \
    {                                                                                                                          \
        (void)references, (void)values;                                                                                        \
        return count == 0 ? OK : told(c, "the FMU has only real variables");                                                     \
    }
NO_GETTER(fmi2GetInteger, int)
NO_GETTER(fmi2GetBoolean, Boolean)
NO_GETTER(fmi2GetString, String)
NO_GETTER(fmi2SetInteger, const int)
NO_GETTER(fmi2SetBoolean, const Boolean)
NO_GETTER(fmi2SetString, const String)

EXPORT Status NAMED(fmi2GetFMUstate)(Component c, void **kept);
EXPORT Status NAMED(fmi2GetFMUstate)(Component c, void **kept)
{
    const Instance *instance = c;
    if (*kept == NULL) *kept = instance->callbacks->allocate(1, sizeof(Kept));
    if (*kept == NULL) return told(instance, "out of memory for the state of the FMU");
    memcpy(*kept, &instance->kept, sizeof(Kept));
    return OK;
}

EXPORT Status NAMED(fmi2SetFMUstate)(Component c, void *kept);
EXPORT Status NAMED(fmi2SetFMUstate)(Component c, void *kept)
{
    memcpy(&((Instance *)c)->kept, kept, sizeof(Kept));
    return OK;
}

EXPORT Status NAMED(fmi2FreeFMUstate)(Component c, void **kept);
EXPORT Status NAMED(fmi2FreeFMUstate)(Component c, void **kept)
{
    if (*kept != NULL) ((Instance *)c)->callbacks->release(*kept);
    *kept = NULL;
    return OK;
}

EXPORT Status NAMED(fmi2SerializedFMUstateSize)(Component c, void *kept, size_t *size);
EXPORT Status NAMED(fmi2SerializedFMUstateSize)(Component c, void *kept, size_t *size)
{
    (void)c, (void)kept;
    *size = sizeof(Kept);
    return OK;
}

EXPORT Status NAMED(fmi2SerializeFMUstate)(Component c, void *kept, char bytes[], size_t size);
EXPORT Status NAMED(fmi2SerializeFMUstate)(Component c, void *kept, char bytes[], size_t size)
{
    if (size < sizeof(Kept)) return told(c, "the buffer is too small for the state of the FMU");
    memcpy(bytes, kept, sizeof(Kept));
    return OK;
}

EXPORT Status NAMED(fmi2DeSerializeFMUstate)(Component c, const char bytes[], size_t size, void **kept);
EXPORT Status NAMED(fmi2DeSerializeFMUstate)(Component c, const char bytes[], size_t size, void **kept)
{
    const Instance *instance = c;
    if (size != sizeof(Kept)) return told(instance, "the bytes are not a state of this FMU");
    if (*kept == NULL) *kept = instance->callbacks->allocate(1, sizeof(Kept));
    if (*kept == NULL) return told(instance, "out of memory for the state of the FMU");
    memcpy(*kept, bytes, sizeof(Kept));
    return OK;
}

EXPORT Status NAMED(fmi2GetDirectionalDerivative)(Component c, const Reference unknowns[], size_t rows, const Reference knowns[],
                                                  size_t columns, const double change[], double result[]);
EXPORT Status NAMED(fmi2GetDirectionalDerivative)(Component c, const Reference unknowns[], size_t rows, const Reference knowns[],
                                                  size_t columns, const double change[], double result[])
{
    (void)unknowns, (void)rows, (void)knowns, (void)columns, (void)change, (void)result;
    return told(c, "the FMU provides no directional derivatives");
}

EXPORT Status NAMED(fmi2SetRealInputDerivatives)(Component c, const Reference references[], size_t count, const int orders[],
                                                 const double values[]);
EXPORT Status NAMED(fmi2SetRealInputDerivatives)(Component c, const Reference references[], size_t count, const int orders[],
                                                 const double values[])
{
    (void)references, (void)count, (void)orders, (void)values;
    return told(c, "inputs are sampled and have no derivatives");
}

EXPORT Status NAMED(fmi2GetRealOutputDerivatives)(Component c, const Reference references[], size_t count, const int orders[],
                                                  double values[]);
EXPORT Status NAMED(fmi2GetRealOutputDerivatives)(Component c, const Reference references[], size_t count, const int orders[],
                                                  double values[])
{
    (void)references, (void)count, (void)orders, (void)values;
    return told(c, "outputs are sampled and have no derivatives");
}

/* Run the samples at multiples of MODEL_PERIOD from the start, up to but without `now + step`. */
EXPORT Status NAMED(fmi2DoStep)(Component c, double now, double step, Boolean final);
EXPORT Status NAMED(fmi2DoStep)(Component c, double now, double step, Boolean final)
{
    Instance *instance = c;
    Kept *kept = &instance->kept;
    const double end = now + step - kept->start - 1e-6 * MODEL_PERIOD;
    model_input in;
    model_output out;
    (void)final;
    if (!is_in(instance, STEPPING)) return told(instance, "the FMU is not in step mode");
    if (!(step >= 0.0)) return told(instance, "the step size is negative or not a number");
    memcpy(&in, kept->in, sizeof in);
    for (; kept->done * MODEL_PERIOD < end; kept->done += 1.0) {
        MODEL_STEP(&kept->state, &in, &out);
        memcpy(kept->out, &out, sizeof out);
    }
    return OK;
}

EXPORT Status NAMED(fmi2CancelStep)(Component c);
EXPORT Status NAMED(fmi2CancelStep)(Component c)
{
    return told(c, "every step completes at once: no step can be cancelled");
}

#define NO_STATUS(function, type)                                                                                              \
    EXPORT Status NAMED(function)(Component c, int kind, type *value);                                                         \
    EXPORT Status NAMED(function)(Component c, int kind, type *value)                                                          \
    {                                                                                                                          \
        (void)c, (void)kind, (void)value;                                                                                      \
        return DISCARD;                                                                                                        \
    }
NO_STATUS(fmi2GetStatus, Status)
NO_STATUS(fmi2GetRealStatus, double)
NO_STATUS(fmi2GetIntegerStatus, int)
NO_STATUS(fmi2GetBooleanStatus, Boolean)
NO_STATUS(fmi2GetStringStatus, String)
