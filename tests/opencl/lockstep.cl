// A ray takes its steps while any ray of its sub-group, whose lanes run in lockstep, has steps left.
__kernel void trace(__global const uint *steps, __global uint *steps_of_lane, __global uint *steps_of_warp) {
    uint ray = get_global_id(0);
    uint left = steps[ray], own = 0, all = 0;
    while (sub_group_any(left > 0)) {
        all++;
        if (left > 0) {
            left--;
            own++;
        }
    }
    steps_of_lane[ray] = own;
    steps_of_warp[ray] = all;
}
