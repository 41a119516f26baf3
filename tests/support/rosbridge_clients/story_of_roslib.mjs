// What `tests/process/test_rosbridge_clients.py` tells, told by npm's roslib under node.
//
//     node story_of_roslib.mjs ROSLIB_MODULE HOST:PORT TOKEN

const [module, address, token] = process.argv.slice(2);
const { Ros, Service, Topic } = await import(module);

/** Hear a topic, and return what waits for the next message that is wanted. */
function subscribe(ros, name) {
  const heard = [];
  let wake = () => {};
  new Topic({ ros, name, messageType: "" }).subscribe((message) => {
    heard.push(message);
    wake();
  });
  return async (isIt = () => true) => {
    for (;;) {
      while (heard.length) {
        const message = heard.shift();
        if (isIt(message)) return message;
      }
      await new Promise((resolve) => (wake = resolve));
    }
  };
}

function call(ros, request) {
  const name = "actuation/change_mode";
  const service = new Service({ ros, name, serviceType: "system_modes_msgs/ChangeMode" });
  return new Promise((resolve) =>
    service.callService(request, resolve, (error) => resolve({ error })),
  );
}

async function tell() {
  const ros = new Ros();
  const connected = new Promise((resolve) => ros.on("connection", resolve));
  ros.callOnConnection({ op: "auth", token });
  await ros.connect(`ws://${address}/rosbridge`);
  await connected;
  const nextState = subscribe(ros, "/system_state");
  const nextEvent = subscribe(ros, "/actuation/mode_event");
  const told = {
    topics: await new Promise((resolve) => ros.getTopics(({ topics }) => resolve(topics))),
    states: [],
  };
  const time = new Service({ ros, name: "/rosapi/get_time", serviceType: "rosapi/GetTime" });
  const now = await new Promise((resolve) => time.callService({}, resolve));
  told.time = now.time.sec + now.time.nanosec / 1e9;
  while (told.states.length < 40) told.states.push(await nextState());
  told.changed = await call(ros, { mode_name: "PERFORMANCE" });
  told.event = await nextEvent((event) => event.goal_mode.label === "PERFORMANCE");
  told.failed = await call(ros, { mode_name: 7 });
  const status = new Promise((resolve) => ros.on("status:bad", resolve));
  ros.callOnConnection({ op: "no_such_op", id: "bad" });
  told.status = await status;
  new Topic({ ros, name: "/estop", messageType: "pilothouse_msgs/EmergencyStop" }).publish({
    enabled: true,
  });
  told.stopped = await nextState((state) => state.state === 2);
  ros.close();
  return told;
}

console.log(JSON.stringify(await tell()));
process.exit(0);
